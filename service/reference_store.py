"""References of whole series, kept on disk cell by cell: they are exact, so each is computed once for ever.

A stored cell is found by its inputs and by the content of the reference code, so a change of that code forgets them
all.
"""

from __future__ import annotations

import hashlib
import struct
from collections.abc import Sequence
from dataclasses import astuple, fields
from functools import cache
from pathlib import Path

from lavapipe import Cache, default_cache
from service import reference
from service.reference import CellReference
from service.scene import Question, SeriesPlan, radians

_FIELDS = len(fields(CellReference))


def plan_reference(plan: SeriesPlan, theta_o_deg: Sequence[float], store: Cache) -> list[CellReference] | None:
    """The reference of every angle, from the store where it is there. None where the pair has none.

    A user's own file has none, whatever its name.
    """
    if plan.model.own or plan.technique.own:
        return None
    keys = [_key(plan, angle) for angle in theta_o_deg]
    known = {key: value for key, value in store.get_many(keys).items() if len(value) == 8 * _FIELDS}
    missing = [(key, angle) for key, angle in zip(keys, theta_o_deg, strict=True) if key not in known]
    if missing:
        angles = [radians(angle) for _, angle in missing]
        phi_o = radians(plan.azimuth_deg)
        fresh = reference.cells_reference(plan.model.name, plan.technique.name, plan.parameters, angles, phi_o)
        if fresh is None:
            return None
        packed = {
            key: struct.pack(f"<{_FIELDS}d", *astuple(cell)) for (key, _), cell in zip(missing, fresh, strict=True)
        }
        store.put_many(packed)
        known |= packed
    return [CellReference(*struct.unpack(f"<{_FIELDS}d", known[key])) for key in keys]


def missing_references(question: Question, store: Cache | None = None) -> int:
    """How many cells of a question have a reference that is not stored yet, and takes milliseconds to compute."""
    store = default_cache() if store is None else store
    keys = {
        _key(plan, angle)
        for plan in question.series
        if reference.load_model(plan.model.name) and reference.load_technique(plan.technique.name)
        for angle in question.scene.angles_deg
    }
    return len(keys) - len(store.get_many(keys))


def _key(plan: SeriesPlan, angle: float) -> str:
    values = ",".join(f"{name}={value!r}" for name, value in sorted(plan.parameters.items()))
    return f"reference:{_code_digest()}:{plan.model.name}:{plan.technique.name}:{values}:{angle!r}:{plan.azimuth_deg!r}"


@cache
def _code_digest() -> str:
    folder = Path(reference.__file__).parent
    digest = hashlib.blake2b(digest_size=8)
    for path in sorted(folder.rglob("*.py")):
        digest.update(path.read_bytes())
    return digest.hexdigest()
