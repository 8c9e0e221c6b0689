"""Error against run time: what a call costs, how errors fall with samples and time, and who reaches a target first."""

from service.convergence.result import compute_convergence
from service.convergence.scene import ConvergenceScene, parse_convergence_scene
from service.convergence.timings import compute_timings

__all__ = ["ConvergenceScene", "compute_convergence", "compute_timings", "parse_convergence_scene"]
