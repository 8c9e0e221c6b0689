"""What was asked, checked, with the key that its result is stored under.

The key is a hash of all that the result depends on: the question in full, the text of the shaders, the driver, and the
code of this version. Equal questions have equal keys, however they were asked.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

import lavapipe
from service.catalogue import SHADERS, Catalogue, Entry
from service.scene import Question, Scene, resolve


@dataclass(frozen=True)
class Asked:
    """A question of a kind, and its key."""

    kind: str
    question: Question
    key: str


def ask(kind: str, scene: Scene, catalogue: Catalogue, device: Mapping[str, Any] | None) -> Asked:
    """Check a scene against the catalogue and form the key. Raises BadInput."""
    question = resolve(scene, catalogue)
    entries = {entry.origin: entry for plan in question.series for entry in (plan.model, plan.technique)}
    parts = [
        kind,
        question.scene.model_dump_json(),
        json.dumps([(device or {}).get(name) for name in ("name", "driver")]),
        _code_digest(),
        *(_entry_digest(entries[origin]) for origin in sorted(entries)),
    ]
    return Asked(kind, question, hashlib.blake2b("\0".join(parts).encode(), digest_size=20).hexdigest())


def own_key(task: str, arguments: Mapping[str, Any], device: Mapping[str, Any] | None) -> str:
    """The key of a question about a user's own file, whose text is among the arguments."""
    parts = [task, arguments, [(device or {}).get(name) for name in ("name", "driver")], _code_digest()]
    return hashlib.blake2b(json.dumps(parts, sort_keys=True).encode(), digest_size=20).hexdigest()


@cache
def _entry_digest(entry: Entry) -> str:
    return hashlib.blake2b(entry.code.encode()).hexdigest()


@cache
def _code_digest() -> str:
    """A hash of the program itself: its Python files, and the shaders that every variant is made of."""
    service = Path(__file__).resolve().parent.parent
    files = [*service.rglob("*.py"), *Path(lavapipe.__file__).parent.rglob("*.py")]
    files += [*SHADERS.glob("*.comp"), *(SHADERS / "common").glob("*.glsl")]
    digest = hashlib.blake2b()
    for path in sorted(files):
        digest.update(path.name.encode() + b"\0" + path.read_bytes())
    return digest.hexdigest()
