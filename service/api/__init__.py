"""The HTTP service: routes, problems, representations. It holds no logic of its own: answers come from `service.jobs`,
which has them computed by a worker process.
"""
