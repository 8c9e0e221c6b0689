"""References of whole series, kept on disk cell by cell: they are exact, so each is computed once for ever.

A stored cell is found by its inputs and by the content of the code that it comes from, the reference's in Python or the
shader's with that of its integration, so a change of that code forgets it.
"""

from __future__ import annotations

import struct
from collections.abc import Callable, Sequence
from dataclasses import astuple, fields
from functools import cache
from hashlib import blake2b
from pathlib import Path

from lavapipe import Cache, CompileError, default_cache
from service import reference
from service.catalogue import SHADERS
from service.device_reference import device_reference
from service.engine import Engine
from service.errors import ShaderFileError
from service.reference import CellReference
from service.scene import Question, SeriesPlan, radians
from service.variant import compose

_FIELDS = len(fields(CellReference))
_CODE = frozenset({".py", ".glsl", ".comp"})


def plan_reference(plan: SeriesPlan, theta_o_deg: Sequence[float], engine: Engine) -> list[CellReference] | None:
    """The reference of every angle, from the store where it is there: from the formulas in Python, or, for a pair that
    has none, from its own code in double precision on the device.

    None for code that does not compile with double in place of float. Raises otherwise as `device_reference` does.
    """
    if has_formulas(plan):
        phi_o = radians(plan.azimuth_deg)

        def compute(angles: Sequence[float]) -> list[CellReference]:
            theta_o = [radians(angle) for angle in angles]
            return (
                reference.cells_reference(plan.model.name, plan.technique.name, plan.parameters, theta_o, phi_o) or []
            )

        return _stored(plan, _code_digest(), theta_o_deg, engine.cache, compute)
    code = compose(engine.catalogue, plan.model, plan.technique, "quadrature", "double")
    digest = blake2b(code.source.encode() + repr(sorted(code.includes.items())).encode(), digest_size=8)
    digest.update(_device_code_digest().encode())
    try:
        return _stored(
            plan, digest.hexdigest(), theta_o_deg, engine.cache, lambda angles: device_reference(plan, engine, angles)
        )
    except (CompileError, ShaderFileError):
        return None


def has_formulas(plan: SeriesPlan) -> bool:
    """Whether the reference in Python knows the pair. It does not know a user's own file, whatever its name."""
    known = reference.load_model(plan.model.name) and reference.load_technique(plan.technique.name)
    return not (plan.model.own or plan.technique.own) and known is not None


def _stored(
    plan: SeriesPlan,
    code: str,
    theta_o_deg: Sequence[float],
    store: Cache,
    compute: Callable[[Sequence[float]], list[CellReference]],
) -> list[CellReference]:
    keys = [_key(plan, code, angle) for angle in theta_o_deg]
    known = {key: value for key, value in store.get_many(keys).items() if len(value) == 8 * _FIELDS}
    missing = [(key, angle) for key, angle in zip(keys, theta_o_deg, strict=True) if key not in known]
    if missing:
        fresh = compute([angle for _, angle in missing])
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
        _key(plan, _code_digest(), angle)
        for plan in question.series
        if has_formulas(plan)
        for angle in question.scene.angles_deg
    }
    return len(keys) - len(store.get_many(keys))


def _key(plan: SeriesPlan, code: str, angle: float) -> str:
    values = ",".join(f"{name}={value!r}" for name, value in sorted(plan.parameters.items()))
    return f"reference:{code}:{plan.model.name}:{plan.technique.name}:{values}:{angle!r}:{plan.azimuth_deg!r}"


@cache
def _code_digest() -> str:
    return _digest_of(Path(reference.__file__).parent)


@cache
def _device_code_digest() -> str:
    folder = Path(__file__).parent
    return _digest_of(folder / "device_reference", folder / "estimators", folder / "checks", SHADERS)


def _digest_of(*folders: Path) -> str:
    digest = blake2b(digest_size=8)
    for path in sorted(path for folder in folders for path in folder.glob("**/*.*") if path.suffix in _CODE):
        digest.update(path.read_bytes())
    return digest.hexdigest()
