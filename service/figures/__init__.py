"""Charts of results, in Altair: the figures of papers on samplers, from the numbers of this program."""

from service.figures.convergence import convergence_chart
from service.figures.layout import AnyChart
from service.figures.roughness import roughness_chart
from service.figures.statistics import statistics_chart

__all__ = ["AnyChart", "convergence_chart", "roughness_chart", "statistics_chart"]
