"""What is checked: a file or a catalogue entry, with the models or techniques it needs to run."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from service.catalogue import Catalogue, Entry, is_file, own_text
from service.errors import BadInput, Problem

DEFAULT_MODEL = "eon"
DEFAULT_TECHNIQUES = ("cosine", "uniform")


@dataclass(frozen=True)
class Subject:
    """What was asked for, and what it means: a catalogue (with the file in it), a model and techniques."""

    given: str
    catalogue: Catalogue
    model: Entry
    techniques: tuple[Entry, ...]
    fixed: Mapping[str, float]


def select(
    given: str,
    catalogue: Catalogue,
    model: str | None = None,
    techniques: Sequence[str] | None = None,
    fixed: Mapping[str, float] | None = None,
    text: str | None = None,
) -> Subject:
    """Find the subject.

    A technique runs on `model` (default eon, or the first it is made for), a model with `techniques`. Where `text` is
    given, it is the file's, which is not read.
    BadInput names what does not exist or does not fit; ShaderFileError a file that breaks the contract.
    """
    if is_file(given):
        catalogue = catalogue.with_text(own_text(Path(given)) if text is None else text, given)
        entry = next(e for e in (*catalogue.models.values(), *catalogue.techniques.values()) if e.own)
    elif given in catalogue.techniques:
        entry = catalogue.techniques[given]
    elif given in catalogue.models:
        entry = catalogue.models[given]
    else:
        known = ", ".join(sorted({*catalogue.models, *catalogue.techniques}))
        raise BadInput(Problem("subject", given, f"a .glsl file, or one of {known}"))
    roles = entry.head.provides
    the_model = (
        entry if "model" in roles and model in (None, entry.name) else catalogue.model(model or _usual_model(entry))
    )
    if "technique" in roles and techniques is None:
        chosen: tuple[Entry, ...] = (entry,)
    else:
        chosen = tuple(catalogue.technique(name) for name in techniques or DEFAULT_TECHNIQUES)
    fixed = dict(fixed or {})
    for technique in chosen:
        declared = catalogue.parameters_of(the_model, technique)
        for name, value in fixed.items():
            if name not in declared:
                raise BadInput(Problem(f"parameters.{name}", value, "one of " + (", ".join(declared) or "none")))
    return Subject(given, catalogue, the_model, chosen, fixed)


def _usual_model(technique: Entry) -> str:
    made_for = technique.head.models
    return DEFAULT_MODEL if made_for == "any" or DEFAULT_MODEL in made_for else made_for[0]
