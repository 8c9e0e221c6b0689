"""Running a user's own shader file in a process of its own, with limits: it may loop for ever or crash the driver.

`run_isolated` starts the worker, hands it a task as JSON, passes its progress on and returns its result; what goes
wrong there becomes an error here. `confinement` is what the worker gives up before it runs anything of the file.
"""

from service.isolation.parent import Bounds, OwnFileFailed, run_isolated

__all__ = ["Bounds", "OwnFileFailed", "run_isolated"]
