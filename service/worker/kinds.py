"""The kinds of question that are answered over HTTP: one entry each.

A kind's function takes (question, engine, progress) and returns a result whose `kind` is its name. It is imported by
the worker alone, when the first question of its kind arrives.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from importlib import import_module
from typing import Any


@dataclass(frozen=True)
class Kind:
    """One kind of question. `path` is its route, `function` its "module:name".

    A `resumable` one also takes `journal` (see service.statistics.Journal): it is interrupted at any launch, shares the
    device with others, and goes on where it was.
    """

    name: str
    path: str
    title: str
    function: str
    resumable: bool = False

    def load(self) -> Callable[..., dict[str, Any]]:
        """Import the function."""
        module, _, name = self.function.partition(":")
        function: Callable[..., dict[str, Any]] = getattr(import_module(module), name)
        return function


KINDS: Mapping[str, Kind] = {
    kind.name: kind
    for kind in (
        Kind(
            "statistics",
            "/v1/statistics",
            "Mean, variance and largest weight of techniques across view angles",
            "service.statistics:compute_statistics",
            resumable=True,
        ),
    )
}
