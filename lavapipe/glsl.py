"""Composing one GLSL text: includes, defines, and a map from its lines back to the caller's files.

Includes are resolved here and not by glslang, whose own include mechanism reads any file of the host. Lines are kept
with the standard `#line LINE NUMBER`, the number standing for a file name, so that a name may hold any character.
Comments and line continuations are resolved here as well: what glslang reads is what was checked here, whatever the
two might think of a stray quote or backslash.
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
# NUL stands for a newline that does not end a line: one after a backslash, or in a comment.
_COMMENT = re.compile(r'"[^"\n]*"|/\0*/[^\n]*|/\0*\*.*?\*\0*/|(?P<unclosed>/\0*\*)', re.DOTALL)
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
        file, line = name, 1
        logical_lines = _logical_lines(source, name)
        versions = (i for i, logical in enumerate(logical_lines) if logical.directive == "version")
        version = next(versions, None) if len(self.stack) == 1 else None
        if len(self.stack) == 1 and version is None:
            self._emit("#version 460")
            self._emit_defines()
        if version is None:
            # Otherwise nothing may come before #version, not even #line.
            self._emit_line(line, file)
        for index, logical in enumerate(logical_lines):
            following = line + logical.count
            if logical.directive == "line":
                following, file = self._moved(logical.rest, file, line)
                self._emit_line(following, file)
            elif logical.directive == "include":
                self._include(logical.rest, file, line)
                self._emit_line(following, file)
            elif index == version:
                self._emit(logical.code)
                self._emit_defines()
                self._emit_line(following, file)
            elif logical.directive == "extension" and _is_host_include(logical.rest, file, line):
                self._emit(*[""] * logical.count)
            else:
                self._emit(logical.code, *[""] * (logical.count - 1))
            line = following
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
    """A line as a preprocessor sees it, without comments; it covers `count` lines of the file."""

    code: str
    count: int
    directive: str
    rest: str


def _logical_lines(source: str, file: str) -> list[_Logical]:
    if len(source) > _LIMIT_CHARACTERS:
        raise _error(file, 0, f"more than {_LIMIT_CHARACTERS:,} characters")
    if "\0" in source:
        raise _error(file, source[: source.index("\0")].count("\n") + 1, "a NUL character")
    text = source.replace("\r\n", "\n").replace("\r", "\n").replace("\\\n", "\0")

    def blank(match: re.Match[str]) -> str:
        token = match[0]
        if match["unclosed"]:
            raise _error(file, len(re.findall(r"[\n\0]", text[: match.start()])) + 1, "this comment has no end")
        return token if token.startswith('"') else " " + "\0" * len(re.findall(r"[\n\0]", token))

    return [_logical(line) for line in _COMMENT.sub(blank, text).split("\n")]


def _logical(line: str) -> _Logical:
    code = line.replace("\0", "")
    if code.endswith("\\"):
        # The backslash at the very end of a file must not swallow the line that follows in the composed text.
        code += " "
    match = _DIRECTIVE.fullmatch(code)
    return _Logical(code, 1 + line.count("\0"), match[1] if match else "", match[2] if match else "")


def _error(file: str, line: int, message: str) -> CompileError:
    return CompileError([Diagnostic(file, line, message)])
