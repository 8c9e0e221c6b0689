"""Estimators: how the statistics of a series are computed, and which one reaches a tolerance.

`mc` draws counter-based random numbers, `qmc` independent replicates of a scrambled Sobol' sequence, `quadrature`
integrates over the (u1, u2) square of the technique. Each takes a series and gives an `Estimate`.
"""

from service.estimators.choice import estimate
from service.estimators.estimate import Estimate
from service.estimators.sampled import SeriesRun, statistics_so_far

__all__ = ["Estimate", "SeriesRun", "estimate", "statistics_so_far"]
