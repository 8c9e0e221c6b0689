"""The page docs/models.md: what the heads of the shader files say of each model, and what the float64 reference finds.

    python -m service.models_page docs/models.md

Nothing in it is written by hand but the words between the numbers.
"""

from __future__ import annotations

import math
import sys
from collections.abc import Iterator, Sequence
from pathlib import Path

import numpy as np

from service.catalogue import Catalogue, Entry, Parameter, load_catalogue
from service.reference import CellReference, cell_reference, load_model
from service.reference.entry import exact_albedo

VIEWS_DEG = (0.0, 30.0, 60.0, 80.0, 89.0)
ENERGY_VIEWS_DEG = (0.0, 45.0, 75.0, 85.0, 89.9)
VALUES = 9  # of each parameter, in the search for the largest albedo
_HEADER = f"""# Models and techniques

Written by `make docs` from the heads of the files in `shaders/` and from the float64 reference.

- Energy: each parameter is swept over its range with {VALUES} values (mx with my), the others at their defaults, for
  views at {", ".join(f"{angle:g}" for angle in ENERGY_VIEWS_DEG)} degrees.
- Variance: of the throughput weight at the defaults; `inf` where it is infinite or beyond 1e290. Bold: the least of
  those techniques that draw every direction the model reflects.
- Weight: the supremum over all those views.

What the papers say of these models, and what we measured: [eon-claims.md](eon-claims.md),
[kurt-claims.md](kurt-claims.md).
"""


def page(catalogue: Catalogue) -> str:
    """The text of the page."""
    parts = [_HEADER]
    parts += ["\n".join(_model(catalogue, entry)) for entry in catalogue.models.values()]
    parts.append("## Techniques\n\n" + "\n".join(_technique(entry) for entry in catalogue.techniques.values()))
    return "\n\n".join(part.strip("\n") for part in parts) + "\n"


def _model(catalogue: Catalogue, entry: Entry) -> Iterator[str]:
    head = entry.head
    yield f"## `{head.name}`: {head.title}\n"
    yield f"{head.source}.\n"
    yield "| parameter | range | default | meaning |\n|---|---|---|---|"
    for name, parameter in head.parameters.items():
        yield f"| `{name}` | {parameter.allowed} | {parameter.default:g} | {parameter.help} |"
    albedo, where = _largest_albedo(catalogue, entry)
    yield f"\n- Energy: the largest albedo found is {albedo:.6g}, at {where}."
    yield f"- Reciprocity: swapping both directions changes the value by {_asymmetry(entry):.1g} of it at most."
    yield "- Anisotropic: the azimuth of the view matters." if head.anisotropic else "- Isotropic."
    for words in head.singular:
        yield f"- Singular: {words}."
    yield "\n" + "\n".join(_variances(catalogue, entry))


def _variances(catalogue: Catalogue, entry: Entry) -> Iterator[str]:
    """A table of techniques by view angle, the best one of each angle in bold."""
    columns = [f"{angle:g} degrees" for angle in VIEWS_DEG]
    yield f"| variance | {' | '.join(columns)} | weight |\n|{'---|' * (len(VIEWS_DEG) + 2)}"
    found = {name: _cells(catalogue, entry, name) for name in catalogue.techniques_for(entry.name)}
    unbiased = [cells for cells in found.values() if all(cell.uncovered <= 1e-6 * cell.albedo for cell in cells)]
    best = [min(cells[k].variance for cells in unbiased) for k in range(len(VIEWS_DEG))]
    for name, cells in found.items():
        values = [
            f"**{cell.variance:.3g}**" if cell.variance == least else f"{cell.variance:.3g}"
            for cell, least in zip(cells, best, strict=True)
        ]
        largest = max(cell.max_weight for cell in cells)
        yield f"| `{name}` | {' | '.join(values)} | {'no bound' if math.isinf(largest) else f'{largest:.3g}'} |"


def _cells(catalogue: Catalogue, entry: Entry, technique: str) -> list[CellReference]:
    declared = catalogue.parameters_of(entry, catalogue.technique(technique))
    parameters = {name: parameter.default for name, parameter in declared.items()}
    cells = [cell_reference(entry.name, technique, parameters, math.radians(angle)) for angle in VIEWS_DEG]
    return [cell for cell in cells if cell is not None]


def _largest_albedo(catalogue: Catalogue, entry: Entry) -> tuple[float, str]:
    """The largest albedo, and the parameters that are not at their default and the view where it is."""
    technique = catalogue.techniques_for(entry.name)[-1]
    declared = catalogue.parameters_of(entry, catalogue.technique(technique))
    defaults = {name: parameter.default for name, parameter in declared.items()}
    best = (-math.inf, "")
    for change in _changes(entry):
        for angle in ENERGY_VIEWS_DEG:
            value = _albedo(entry.name, technique, defaults | change, math.radians(angle))
            if value > best[0] * (1 + 1e-9):
                changed = "".join(f", {name} {number:.4g}" for name, number in change.items())
                best = (value, f"{angle:g} degrees{changed or ', defaults'}")
    return best


def _changes(entry: Entry) -> Iterator[dict[str, float]]:
    """No change, then each parameter over its range; those of an isotropic pair (mx and my) together."""
    yield {}
    for name, parameter in entry.head.parameters.items():
        twin = name.replace("mx", "my") if "mx" in name else None
        for value in _values(parameter):
            yield {name: value} | ({twin: value} if twin else {})


def _values(parameter: Parameter) -> Sequence[float]:
    if parameter.min > 0 and parameter.max / parameter.min > 100:
        return [float(value) for value in np.geomspace(parameter.min, parameter.max, VALUES)]
    return [float(value) for value in np.linspace(parameter.min, parameter.max, VALUES)]


def _albedo(model: str, technique: str, parameters: dict[str, float], theta_o: float) -> float:
    reference = load_model(model)
    exact = None if reference is None else exact_albedo(reference, math.cos(theta_o), parameters)
    if exact is not None:
        return exact
    cell = cell_reference(model, technique, parameters, theta_o)
    return -math.inf if cell is None else cell.albedo


def _asymmetry(entry: Entry, pairs: int = 2000) -> float:
    """Largest relative change of the BRDF when wi and wo are swapped, over random pairs in the first octant."""
    reference = load_model(entry.name)
    if reference is None:
        return math.nan
    directions = np.random.default_rng(0).normal(size=(2, pairs, 3))
    wi, wo = np.abs(directions / np.linalg.norm(directions, axis=-1, keepdims=True))
    defaults = {name: parameter.default for name, parameter in entry.head.parameters.items()}
    there, back = reference.brdf(wi, wo, defaults), reference.brdf(wo, wi, defaults)
    return float(np.max(np.abs(there - back) / np.maximum(np.abs(there), 1e-300)))


def _technique(entry: Entry) -> str:
    head = entry.head
    models = "any model" if head.models == "any" else ", ".join(f"`{name}`" for name in head.models)
    facts = [
        words
        for words, holds in (("a mixture", head.mixture), ("draws below the horizon", head.below_horizon))
        if holds
    ]
    own = "".join(f"; `{name}` {parameter.allowed}, {parameter.help}" for name, parameter in head.parameters.items())
    return f"- `{head.name}`: {head.title}, for {models}{'; ' + ', '.join(facts) if facts else ''}{own}. {head.source}."


def main() -> None:
    """Write the page to the path given."""
    Path(sys.argv[1]).write_text(page(load_catalogue()), encoding="utf-8")


if __name__ == "__main__":
    main()
