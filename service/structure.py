"""The structure of a shader: what it computes and what it leaves out, as specialization constants.

Structure is what a compiler can use to drop code. Numbers are no part of it: they come from buffers, so that a sweep
does not compile once per value.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

from service.catalogue import Entry

Role = Literal["model", "technique"]
Constants = dict[int, int | float | bool]

TECHNIQUE_ID = 10
"""The constant that chooses the technique in a shader with several; shaders/common/structure.glsl has those below."""
_FIRST_PARAMETER_ID = 16


@dataclass(frozen=True)
class Fixed:
    """A parameter of the model, or of the technique, that has this very value and so need not be read."""

    role: Role
    name: str
    value: float


@dataclass(frozen=True)
class Structure:
    """Choices that a shader is specialized for. As it is made, nothing is left out.

    moments: the highest power of the weight that is summed, 0 to 4. largest, zeros, first_bad: whether the largest
    weight, the count of zero weights and the index of the first non-finite sample are kept. horizon: whether wi is
    tested for being below the horizon. azimuth: whether wo may leave the x-z plane. formed_once: whether what depends
    on the view alone is formed once for a view and not for every sample. fixed: parameters that are compiled in.
    together: whether all techniques of the scene are in one shader. drawn: False where the answer is known without a
    sample.
    """

    moments: int = 4
    largest: bool = True
    zeros: bool = True
    first_bad: bool = True
    horizon: bool = True
    azimuth: bool = True
    formed_once: bool = False
    fixed: frozenset[Fixed] = frozenset()
    together: bool = True
    drawn: bool = True

    def shared_constants(self, model: Entry, techniques: Sequence[Entry], chosen: int = 0) -> Constants:
        """Specialization constants of any job that weighs samples, of a model with one technique or several."""
        found: Constants = {8: self.horizon, 9: self.azimuth}
        if len(techniques) > 1:
            found[TECHNIQUE_ID] = chosen
        at = {slot: i for i, slot in enumerate(parameter_slots(model, techniques))}
        prefixes = {"model": "model", "technique": technique_prefixes(techniques)[chosen]}
        for one in self.fixed:
            is_fixed, value = parameter_ids(at[prefixes[one.role], one.name])
            found |= {is_fixed: True, value: one.value}
        return found

    def statistics_constants(
        self, model: Entry, techniques: Sequence[Entry], chosen: int = 0, *, sobol: bool = False
    ) -> Constants:
        """Specialization constants of the job `statistics`, whose own ids are in its file."""
        own: Constants = {
            0: self.moments,
            1: self.largest,
            2: sobol,
            3: self.zeros,
            4: self.first_bad,
            5: self.formed_once,
        }
        return own | self.shared_constants(model, techniques, chosen)


def technique_prefixes(techniques: Sequence[Entry]) -> list[str]:
    """What stands before the names of each technique in one shader."""
    return ["technique"] if len(techniques) == 1 else [f"technique_{i}" for i in range(len(techniques))]


def read_parameters(entry: Entry, role: Role) -> list[str]:
    """The parameters that the code of a file reads in this role."""
    return [*entry.head.parameters, *(entry.head.uses if role == "technique" else [])]


def parameter_slots(model: Entry, techniques: Sequence[Entry]) -> list[tuple[str, str]]:
    """(prefix, name) of every parameter of every part of a shader; model and technique may read the same one."""
    slots = [("model", name) for name in read_parameters(model, "model")]
    for prefix, technique in zip(technique_prefixes(techniques), techniques, strict=True):
        slots += [(prefix, name) for name in read_parameters(technique, "technique")]
    return slots


def parameter_ids(slot: int) -> tuple[int, int]:
    """Ids of the two constants of a slot: whether it is fixed, and the value."""
    return _FIRST_PARAMETER_ID + 2 * slot, _FIRST_PARAMETER_ID + 2 * slot + 1
