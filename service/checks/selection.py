"""What is checked: a file or a catalogue entry, with the models or techniques it needs to run."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from types import MappingProxyType

from service.catalogue import DEFAULT_MODEL, Catalogue, Entry, is_file, own_text
from service.errors import BadInput, Problem

DEFAULT_TECHNIQUES = ("cosine", "uniform")
NO_FILES: Mapping[str, str] = MappingProxyType({})


@dataclass(frozen=True)
class Subject:
    """What was asked for, and what it means: a catalogue (with the file in it), a model and techniques."""

    given: str
    catalogue: Catalogue
    model: Entry
    techniques: tuple[Entry, ...]
    fixed: Mapping[str, float]


def with_files(catalogue: Catalogue, files: Mapping[str, str]) -> Catalogue:
    """The catalogue with files, given as text by path."""
    for path, text in files.items():
        catalogue = catalogue.with_text(text, path)
    return catalogue


def name_of(given: str, catalogue: Catalogue, files: Mapping[str, str]) -> str:
    """The name of the entry that a path among `files` stands for; a name stands for itself."""
    return catalogue.file_of(given).name if given in files else given


def select(
    given: str,
    catalogue: Catalogue,
    model: str | None = None,
    techniques: Sequence[str] | None = None,
    fixed: Mapping[str, float] | None = None,
    files: Mapping[str, str] = NO_FILES,
) -> Subject:
    """Find the subject.

    A technique runs on `model` (default eon, or the first it is made for), a model with `techniques`: names, or paths
    that `files` has the texts of. A subject that is a file is read only where `files` has not its text.
    BadInput names what does not exist or does not fit; ShaderFileError a file that breaks the contract.
    """
    if is_file(given) and given not in files:
        files = {**files, given: own_text(Path(given))}
    catalogue = with_files(catalogue, files)
    if given in files:
        entry = catalogue.file_of(given)
    elif given in catalogue.techniques:
        entry = catalogue.techniques[given]
    elif given in catalogue.models:
        entry = catalogue.models[given]
    else:
        known = ", ".join(sorted({*catalogue.models, *catalogue.techniques}))
        raise BadInput(Problem("subject", given, f"a .glsl file, or one of {known}"))
    model = None if model is None else name_of(model, catalogue, files)
    techniques = None if techniques is None else [name_of(name, catalogue, files) for name in techniques]
    roles = entry.head.provides
    if "model" not in roles and entry.name not in (techniques or [entry.name]):
        raise BadInput(Problem("techniques", ",".join(techniques or []), f"{entry.name}, the subject, or no value"))
    the_model = (
        entry
        if "model" in roles and model in (None, entry.name)
        else catalogue.model(model or _usual_model(entry, catalogue))
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


def require_in_range(subject: Subject) -> None:
    """Raise BadInput where a fixed parameter is outside its range. (A replay may be: the edge grid looks beyond.)"""
    for technique in subject.techniques:
        declared = subject.catalogue.parameters_of(subject.model, technique)
        for name, value in subject.fixed.items():
            if not declared[name].min <= value <= declared[name].max:
                raise BadInput(Problem(f"parameters.{name}", value, declared[name].allowed))


def _usual_model(technique: Entry, catalogue: Catalogue) -> str:
    made_for = technique.head.models
    if made_for == "any" or DEFAULT_MODEL in made_for:
        return DEFAULT_MODEL
    known = [name for name in made_for if name in catalogue.models]
    if not known:
        names = ", ".join(made_for) or "no model"
        raise BadInput(Problem("model", None, f"a model or its file; {technique.origin} is made for {names}"))
    return known[0]
