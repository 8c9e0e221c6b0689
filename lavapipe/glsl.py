"""Composing one GLSL text: includes, defines, and a map from its lines back to the caller's files.

Includes are resolved here and not by glslang, whose own include mechanism reads any file of the host. Lines are kept
with the standard `#line LINE NUMBER`, the number standing for a file name, so that a name may hold any character.
"""

from __future__ import annotations

import math
import re
from collections.abc import Mapping
from dataclasses import dataclass, field

from lavapipe.errors import CompileError, Diagnostic, InvalidArgument

_LIMIT_CHARACTERS = 4 << 20
_LIMIT_DEPTH = 64
_DIRECTIVE = re.compile(r"\s*#\s*(\w*)(.*)", re.DOTALL)
_INCLUDE = re.compile(r'\s*(?:"([^"]+)"|<([^>]+)>)\s*')
_LINE = re.compile(r'\s*(\d{1,9})(?:\s+(?:"([^"]*)"|(\d+)))?\s*')
_EXTENSION = re.compile(r"\s*(\w+)\s*:\s*\w+\s*")
_IDENTIFIER = re.compile(r"[A-Za-z_]\w*", re.ASCII)
_TOKENS = re.compile(r'//[^\n]*|/\*|"[^"\n]*"')
# Each would let a source reach the files of the host through glslang; `all` switches them on as well.
_HOST_INCLUDES = ("GL_GOOGLE_include_directive", "GL_ARB_shading_language_include", "all")

Define = str | int | float


@dataclass(frozen=True)
class Composed:
    """A GLSL text without includes, and the file names that its `#line` numbers stand for."""

    text: str
    files: tuple[str, ...]


def compose(source: str, name: str, include: Mapping[str, str], defines: Mapping[str, Define]) -> Composed:
    """One text from the source, the included texts and the defines.

    Raises CompileError (an unknown or endless include, a malformed directive), InvalidArgument for a bad define.
    """
    composer = _Composer(include, [_define_line(*item) for item in defines.items()], list(defines))
    composer.add(source, name)
    return Composed("\n".join(composer.lines) + "\n", tuple(composer.files))


def _define_line(name: str, value: Define) -> str:
    if not isinstance(name, str) or not _IDENTIFIER.fullmatch(name):
        raise InvalidArgument(f"defines: {name!r} is no identifier")
    if isinstance(value, bool):
        value = int(value)
    if isinstance(value, float) and not math.isfinite(value):
        raise InvalidArgument(f"defines: {name}={value}: GLSL has no literal for it")
    if isinstance(value, str) and re.search(r"[\r\n\0\\]", value):
        raise InvalidArgument(f"defines: {name}={value!r}: one line, without a backslash")
    return f"#define {name} {value}"


@dataclass
class _Composer:
    include: Mapping[str, str]
    defines: list[str]
    define_names: list[str]
    lines: list[str] = field(default_factory=list)
    files: list[str] = field(default_factory=list)
    characters: int = 0
    stack: list[str] = field(default_factory=list)

    def add(self, source: str, name: str) -> None:
        """Append a file's text, its includes expanded."""
        self.stack.append(name)
        file, line, first = name, 1, len(self.stack) == 1
        if first and "#version" not in source:
            self._emit("#version 460")
            self._emit_defines()
        self._emit_line(line, file)
        for logical in _logical_lines(source, name):
            if logical.directive == "include":
                self._include(logical.rest, file, line)
                self._emit_line(line + logical.count, file)
            elif logical.directive == "line":
                line, file = self._moved(logical.rest, file, line)
                self._emit_line(line, file)
                continue
            elif logical.directive == "extension" and _is_host_include(logical.rest, file, line):
                self._emit(*[""] * logical.count)
            elif first and logical.directive == "version":
                # Nothing may come before #version, not even #line.
                self.lines = [text for text in self.lines if not text.startswith("#line")]
                self._emit(*logical.text)
                self._emit_defines()
                self._emit_line(line + logical.count, file)
            else:
                self._emit(*logical.text)
            line += logical.count
        self.stack.pop()

    def _emit(self, *lines: str) -> None:
        self.lines.extend(lines)
        self.characters += sum(len(line) + 1 for line in lines)
        if self.characters > _LIMIT_CHARACTERS:
            raise _error(self.stack[0], 0, f"more than {_LIMIT_CHARACTERS:,} characters with all includes")

    def _emit_line(self, line: int, file: str) -> None:
        if file not in self.files:
            self.files.append(file)
        # Number 0 is avoided: glslang names the source itself instead of it.
        self._emit(f"#line {line} {self.files.index(file) + 1}")

    def _emit_defines(self) -> None:
        for name, line in zip(self.define_names, self.defines, strict=True):
            self._emit_line(1, f"<define {name}>")
            self._emit(line)

    def _include(self, rest: str, file: str, line: int) -> None:
        match = _INCLUDE.fullmatch(rest)
        if match is None:
            raise _error(file, line, f"#include{rest}: a name in quotes is needed")
        name = match[1] or match[2]
        if name not in self.include:
            raise _error(file, line, f"#include {rest.strip()}: there is no such file to include")
        if name in self.stack:
            raise _error(file, line, f"#include {rest.strip()}: includes itself: {' > '.join([*self.stack, name])}")
        if len(self.stack) >= _LIMIT_DEPTH:
            raise _error(file, line, f"#include {rest.strip()}: more than {_LIMIT_DEPTH} files deep")
        self.add(self.include[name], name)

    @staticmethod
    def _moved(rest: str, file: str, line: int) -> tuple[int, str]:
        match = _LINE.fullmatch(rest)
        if match is None:
            raise _error(file, line, f'#line{rest}: #line NUMBER "FILE" is needed')
        named = match[2] if match[2] is not None else match[3]
        return int(match[1]), file if named is None else named


def _is_host_include(rest: str, file: str, line: int) -> bool:
    match = _EXTENSION.fullmatch(rest)
    if match is None:
        raise _error(file, line, f"#extension{rest}: #extension NAME : BEHAVIOUR is needed")
    return match[1] in _HOST_INCLUDES


@dataclass(frozen=True)
class _Logical:
    """A line as the preprocessor sees it: `count` lines of the file, joined by backslashes and block comments."""

    text: list[str]
    directive: str
    rest: str

    @property
    def count(self) -> int:
        return len(self.text)


def _logical_lines(source: str, file: str) -> list[_Logical]:
    if "\0" in source:
        raise _error(file, source[: source.index("\0")].count("\n") + 1, "a NUL character")
    physical = source.replace("\r\n", "\n").replace("\r", "\n").split("\n")
    logical, at = [], 0
    while at < len(physical):
        end, code = at + 1, _without_comments(physical[at])
        while end < len(physical) and (code is None or physical[end - 1].endswith("\\")):
            end += 1
            code = _without_comments(_spliced(physical[at:end]))
        match = _DIRECTIVE.fullmatch(code or "")
        text = physical[at:end]
        logical.append(_Logical(text, match[1] if match else "", match[2] if match else ""))
        at = end
    return logical


def _spliced(lines: list[str]) -> str:
    return "\n".join(lines).replace("\\\n", "")


def _without_comments(text: str) -> str | None:
    """The text with each comment as one space; None where a block comment is still open at its end."""
    parts, at = [], 0
    while match := _TOKENS.search(text, at):
        parts.append(text[at : match.start()])
        at = match.end()
        if match[0] == "/*":
            close = text.find("*/", at)
            if close < 0:
                return None
            at = close + 2
            parts.append(" ")
        elif match[0].startswith('"'):
            parts.append(match[0])
    parts.append(text[at:])
    return "".join(parts)


def _error(file: str, line: int, message: str) -> CompileError:
    return CompileError([Diagnostic(file, line, message)])
