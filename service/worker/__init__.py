"""The worker: a process of its own that owns the Vulkan device, and what starts, watches and restarts it.

A driver that crashes, a shader that hangs or a process that is killed takes a worker with it, never the server. `lane`
is the server's side, `python -m service.worker` the other, `protocol` what they say to each other.
"""
