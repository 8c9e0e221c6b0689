"""GLSL source text: what a file declares at its top level, and renaming it into a namespace of its own.

GLSL has no namespaces. A model and a technique are separate files that may use equal helper names, so every name a file
declares gets the file's prefix. Text is rewritten token by token: lines stay where they are, so that compile errors
keep the author's line numbers.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence

_TOKEN = re.compile(
    r"""
    (?P<comment>//[^\n]*|/\*.*?\*/)
  | (?P<directive>^[ \t]*\#(?:\\\n|[^\n])*)
  | (?P<number>(?:0[xX][0-9a-fA-F]+|(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?)[a-zA-Z]*)
  | (?P<name>[A-Za-z_]\w*)
  | (?P<space>\s+)
  | (?P<mark>.)
    """,
    re.VERBOSE | re.DOTALL | re.MULTILINE,
)
_DEFINE = re.compile(r"^[ \t]*#[ \t]*define[ \t]+([A-Za-z_]\w*)")
_QUALIFIERS = frozenset({"const", "in", "out", "inout", "precise", "highp", "mediump", "lowp"})
_NAME = re.compile(r"\b[A-Za-z_]\w*\b")


def tokens(text: str) -> Iterator[tuple[str, str]]:
    """Yield (kind, text) of every token: comment, directive, number, name, space or mark. Joined, they are the text."""
    for match in _TOKEN.finditer(text):
        yield str(match.lastgroup), match.group()


def words(text: str) -> Iterator[tuple[int, str]]:
    """Yield (line, name) of every name in code, comments and directives apart; lines count from 1."""
    line = 1
    for kind, token in tokens(text):
        if kind == "name":
            yield line, token
        line += token.count("\n")


def declared_names(text: str) -> set[str]:
    """Names that a file declares at its top level: functions, globals, structs and macros."""
    names: set[str] = set()
    depth = 0
    previous: tuple[str, str] = ("mark", ";")
    before_previous: tuple[str, str] = ("mark", ";")
    for kind, token in tokens(text):
        if kind in ("comment", "space"):
            continue
        if kind == "directive":
            if match := _DEFINE.match(token):
                names.add(match.group(1))
            continue
        if depth == 0 and previous[0] == "name" and _declares(before_previous, token):
            names.add(previous[1])
        if token in "([{":
            depth += 1
        elif token in ")]}":
            depth -= 1
        before_previous, previous = previous, (kind, token)
    return names


def _declares(before: tuple[str, str], after: str) -> bool:
    """Whether a top-level name between these two tokens is one that is declared there."""
    typed = before[0] == "name" or before[1] in ("]", ",", "}")
    return typed and after in ("(", "=", ";", ",", "[", "{")


def signatures(text: str, name: str) -> list[tuple[int, tuple[str, ...]]]:
    """(line, types) of every function of this name at the top level: the type returned, then those of parameters."""
    found = []
    depth, line = 0, 1
    code: list[tuple[int, str, str]] = []  # line, kind, text
    for kind, token in tokens(text):
        if kind not in ("comment", "space", "directive"):
            code.append((line, kind, token))
        line += token.count("\n")
    for i, (at, kind, token) in enumerate(code):
        before, after = code[i - 1 : i], code[i + 1 : i + 2]
        if depth == 0 and token == name and before and before[0][1] == "name" and after and after[0][2] == "(":
            end = next((j for j in range(i, len(code)) if code[j][2] == ")"), len(code))
            found.append((at, (before[0][2], *_types(code[i + 2 : end]))))
        depth += (token in "([{") - (token in ")]}") if kind == "mark" else 0
    return found


def _types(parameters: Sequence[tuple[int, str, str]]) -> Iterator[str]:
    """The type of each parameter, qualifiers apart."""
    first = True
    for _, kind, token in parameters:
        if first and kind == "name" and token not in _QUALIFIERS:
            yield token
            first = False
        first = first or token == ","


def rename(text: str, names: Mapping[str, str]) -> str:
    """The text with names replaced, in code and in directives, but not behind a dot (members) and not in comments."""
    out = []
    previous = ""
    for kind, token in tokens(text):
        if kind == "name" and previous != "." and token in names:
            out.append(names[token])
        elif kind == "directive" and not token.lstrip(" \t#").startswith("include"):
            out.append(_NAME.sub(lambda match: names.get(match.group(), match.group()), token))
        else:
            out.append(token)
        if kind not in ("comment", "space"):
            previous = token
    return "".join(out)
