"""Widening GLSL text from `float` to `double`, so that a file's own code gives its float64 truth.

GLSL has no transcendental functions of doubles: their names become those of shaders/common/double.glsl. Like renaming,
this works token by token and leaves every line where it is.
"""

from __future__ import annotations

import re

from service import glsl

_TYPES = {
    "float": "double",
    **{f"vec{n}": f"dvec{n}" for n in (2, 3, 4)},
    **{f"mat{n}": f"dmat{n}" for n in (2, 3, 4)},
    **{f"mat{n}x{m}": f"dmat{n}x{m}" for n in (2, 3, 4) for m in (2, 3, 4)},
}
_FUNCTIONS = (
    *("sin", "cos", "tan", "asin", "acos", "atan", "sinh", "cosh", "tanh", "asinh", "acosh", "atanh"),
    *("exp", "log", "exp2", "log2", "pow", "radians", "degrees"),
    *("floatBitsToUint", "floatBitsToInt", "uintBitsToFloat", "intBitsToFloat"),
)
_NAMES = {**_TYPES, **{name: f"double_{name}" for name in _FUNCTIONS}}
_PRECISION = frozenset({"lowp", "mediump", "highp"})
_FLOAT_LITERAL = re.compile(r"((?:\d+\.\d*|\.\d+)(?:[eE][+-]?\d+)?|\d+[eE][+-]?\d+|\d+(?=[fF]$))[fF]?")
_DEFINE = re.compile(r"[ \t]*#[ \t]*define[ \t]+\w+(\([^)]*\))?")


def widen(text: str) -> str:
    """The text in double precision.

    A global constant loses its `const`: the functions of doubles are no constant expressions.
    """
    out: list[str] = []
    depth = 0
    after_dot = False
    statement_start = len(out)
    for kind, token in glsl.tokens(text):
        if kind == "directive":
            out.append(_widened_directive(token))
        elif kind == "number":
            out.append(_literal(token))
        elif kind == "name" and not after_dot:
            out.append("" if token in _PRECISION else _NAMES.get(token, token))
            if depth == 0 and out[-1].lstrip("d") in _GLOBAL_TYPES:
                _drop_const(out, statement_start)
        else:
            out.append(token)
        depth += (token in ("(", "{", "[")) - (token in (")", "}", "]"))
        if kind not in ("comment", "space"):
            after_dot = token == "."
        if depth == 0 and token in (";", "}"):
            _drop_default_precision(out, statement_start)
            statement_start = len(out)
    return "".join(out)


_GLOBAL_TYPES = frozenset(name.lstrip("d") for name in _TYPES.values())


def _literal(token: str) -> str:
    match = _FLOAT_LITERAL.fullmatch(token)
    return f"{match[1]}lf" if match else token


def _drop_const(out: list[str], start: int) -> None:
    for i in range(start, len(out)):
        if out[i] == "const":
            out[i] = ""


def _drop_default_precision(out: list[str], start: int) -> None:
    """Remove a statement `precision highp float;`, which doubles do not have."""
    words = [token for token in out[start:] if token.strip()]
    if words and words[0] == "precision":
        out[start:] = ["\n" * "".join(out[start:]).count("\n")]


def _widened_directive(token: str) -> str:
    """Only the body of a macro holds numbers of the program."""
    match = _DEFINE.match(token)
    if match is None:
        return token
    body = token[match.end() :]
    return match.group() + "".join(
        _literal(part) if kind == "number" else _NAMES.get(part, part) if kind == "name" else part
        for kind, part in glsl.tokens(" " + body)
    )
