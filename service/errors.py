"""The errors a caller can make or meet.

    SamplerscopeError
    ├── BadInput            one or more fields of a request are wrong; each is a `Problem`
    └── ShaderFileError     a model or technique file breaks the contract of shaders/README.md

What the device and the compiler raise is the tree of `lavapipe.errors`.
"""

from __future__ import annotations

import reprlib
from collections.abc import Sequence
from dataclasses import dataclass


@dataclass(frozen=True)
class Problem:
    """One wrong field: its path in the scene, the value given, and what is allowed."""

    field: str
    value: object
    allowed: str

    def __str__(self) -> str:
        return f"{self.field} = {_on_one_line(self.value)}: allowed is {self.allowed}"


def allowed_in_words(message: str) -> str:
    """What a field allows, out of Pydantic's message about a value that it does not."""
    what = message.removeprefix("Input should be ").partition(", unable to parse")[0]
    return what.replace("a valid integer", "a whole number").replace("a valid ", "a ")


class SamplerscopeError(Exception):
    """Base of all errors of this package."""


class BadInput(SamplerscopeError, ValueError):
    """A request with wrong fields. `problems` holds one entry a field; the text is one line."""

    def __init__(self, problems: Sequence[Problem] | Problem) -> None:
        self.problems = (problems,) if isinstance(problems, Problem) else tuple(problems)
        super().__init__("; ".join(str(problem) for problem in self.problems))


class ShaderFileError(SamplerscopeError, ValueError):
    """A shader file that breaks the contract: names the file, the line where known, and the rule."""


_LONGEST = 1000
_repr = reprlib.Repr()
_repr.maxlist = _repr.maxdict = _repr.maxstring = _repr.maxlong = _repr.maxother = _LONGEST


def short(value: object, most: int) -> str:
    """A value that somebody gave as text of at most so many characters, in time that its size does not matter for."""
    text = value[:_LONGEST] if isinstance(value, str) else _repr.repr(value)
    return text if len(text) <= most else text[: most - 3] + "..."


def _on_one_line(value: object) -> str:
    return short(" ".join(short(value, _LONGEST).split()), 80)
