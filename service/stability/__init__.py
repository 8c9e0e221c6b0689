"""Whether a model and technique stay right where formulas break: edges, seams, poles and stiff places."""

from service.stability.answer import compute_stability, survey_pair

__all__ = ["compute_stability", "survey_pair"]
