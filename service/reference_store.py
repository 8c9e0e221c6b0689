"""References of whole series, kept on disk cell by cell: they are exact, so each is computed once for ever.

A stored cell is found by its inputs and by the content of the reference code, so a change of that code forgets them
all. What a user's own file says of itself is not stored.
"""

from __future__ import annotations

import math
import struct
from collections.abc import Sequence
from dataclasses import astuple, fields
from functools import cache
from hashlib import blake2b
from pathlib import Path

from lavapipe import Cache, CompileError, default_cache
from service import reference
from service.catalogue import Catalogue
from service.device_reference import device_reference
from service.engine import Engine
from service.errors import ShaderFileError
from service.reference import CellReference
from service.scene import Question, SeriesPlan

_FIELDS = len(fields(CellReference))


def plan_reference(plan: SeriesPlan, theta_o_deg: Sequence[float], engine: Engine) -> list[CellReference] | None:
    """The reference of every angle: from the formulas in Python, stored; for a pair that has none, from its own code
    in double precision on the device.

    None for code that does not compile with double in place of float. Raises otherwise as `device_reference` does.
    """
    if has_formulas(plan):
        return _stored(plan, theta_o_deg, engine.cache)
    try:
        return device_reference(plan, engine, theta_o_deg)
    except (CompileError, ShaderFileError):
        return None


def has_formulas(plan: SeriesPlan) -> bool:
    """Whether the reference in Python knows the pair. It does not know a user's own file, whatever its name."""
    if plan.model.own or plan.technique.own:
        return False
    names = (reference.load_model(plan.model.name), reference.load_technique(plan.technique.name))
    return None not in names


def load_references(catalogue: Catalogue) -> None:
    """Read all that references of the catalogue need of files, for a process that may read none from then on."""
    for name in catalogue.models:
        reference.load_model(name)
    for name in catalogue.techniques:
        reference.load_technique(name)
    _code_digest()


def _stored(plan: SeriesPlan, theta_o_deg: Sequence[float], store: Cache) -> list[CellReference]:
    keys = [_key(plan, angle) for angle in theta_o_deg]
    known = {key: value for key, value in store.get_many(keys).items() if len(value) == 8 * _FIELDS}
    missing = [(key, angle) for key, angle in zip(keys, theta_o_deg, strict=True) if key not in known]
    if missing:
        names, phi_o = (plan.model.name, plan.technique.name), math.radians(plan.azimuth_deg)
        angles = [math.radians(angle) for _, angle in missing]
        fresh = reference.cells_reference(*names, plan.parameters, angles, phi_o) or []
        packed = {
            key: struct.pack(f"<{_FIELDS}d", *astuple(cell)) for (key, _), cell in zip(missing, fresh, strict=True)
        }
        store.put_many(packed)
        known |= packed
    return [CellReference(*struct.unpack(f"<{_FIELDS}d", known[key])) for key in keys]


def missing_references(question: Question, store: Cache | None = None) -> int:
    """How many cells of a question have a reference that is not stored yet, and takes milliseconds to compute."""
    store = default_cache() if store is None else store
    keys = {_key(plan, angle) for plan in question.series if has_formulas(plan) for angle in question.scene.angles_deg}
    return len(keys) - len(store.get_many(keys))


def _key(plan: SeriesPlan, angle: float) -> str:
    values = ",".join(f"{name}={value!r}" for name, value in sorted(plan.parameters.items()))
    return f"reference:{_code_digest()}:{plan.model.name}:{plan.technique.name}:{values}:{angle!r}:{plan.azimuth_deg!r}"


@cache
def _code_digest() -> str:
    digest = blake2b(digest_size=8)
    for path in sorted(Path(reference.__file__).parent.rglob("*.py")):
        digest.update(path.read_bytes())
    return digest.hexdigest()
