"""Float64 truth on the CPU: exact moments and supremum of the throughput weight, by quadrature in NumPy.

It is written from the formulas, independent of the GLSL, and draws no samples. "The EON paper" is Portsmouth, Kutz,
Hill, "EON: A practical energy-preserving rough diffuse BRDF" (2024). A catalogue entry has a file here under `models/`
or `techniques/`, or none; then the functions return None.
"""

from service.reference.cell import CellReference, cell_reference, cells_reference
from service.reference.entry import Model, Technique, load_model, load_technique

__all__ = [
    "CellReference",
    "Model",
    "Technique",
    "cell_reference",
    "cells_reference",
    "load_model",
    "load_technique",
]
