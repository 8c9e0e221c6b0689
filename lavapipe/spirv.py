"""Reading SPIR-V: what a compute module asks of its pipeline.

A module that disagrees with its pipeline is undefined behaviour in Vulkan: lavapipe reads foreign memory, or the
process dies. So the host reads the module first. Numbers are those of the SPIR-V specification, section 3.
"""

from __future__ import annotations

import numbers
import struct
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from typing import Literal

from lavapipe.errors import InvalidArgument

_MAGIC = 0x07230203
_HEADER_WORDS = 5
_GL_COMPUTE = 5

_ENTRY_POINT, _CAPABILITY = 15, 17
_TYPE_BOOL, _TYPE_INT, _TYPE_FLOAT, _TYPE_VECTOR, _TYPE_MATRIX = 20, 21, 22, 23, 24
_TYPE_ARRAY, _TYPE_STRUCT, _TYPE_POINTER = 28, 30, 32
_CONSTANT, _SPEC_TRUE, _SPEC_FALSE, _SPEC_CONSTANT = 43, 48, 49, 50
_VARIABLE, _DECORATE, _MEMBER_DECORATE = 59, 71, 72
_SPEC_ID, _ARRAY_STRIDE, _MATRIX_STRIDE, _BINDING, _DESCRIPTOR_SET, _OFFSET = 1, 6, 7, 33, 34, 35
_PUSH_CONSTANT, _STORAGE_BUFFER = 9, 12

Kind = Literal["bool", "int", "uint", "float"]


@dataclass(frozen=True)
class SpecConstant:
    """A specialization constant: its scalar type and width in bits (32 for bool, as Vulkan takes it)."""

    kind: Kind
    bits: int

    def encode(self, value: int | float | bool) -> bytes:
        """The value as Vulkan takes it; raises InvalidArgument where the type cannot hold it."""
        if not isinstance(value, numbers.Real):
            raise InvalidArgument(f"{value!r} is no number")
        try:
            if self.kind == "float":
                return struct.pack({16: "<e", 32: "<f", 64: "<d"}[self.bits], value)
            if int(value) == value and (self.kind != "bool" or value in (0, 1)):
                return int(value).to_bytes(self.bits // 8, "little", signed=self.kind == "int")
        except (OverflowError, ValueError):
            pass
        raise InvalidArgument(
            f"{value!r} does not fit {self.kind if self.kind == 'bool' else self.kind + str(self.bits)}"
        )


@dataclass(frozen=True)
class Module:
    """What a compute module asks for.

    `bindings` are the (set, binding) of its storage buffers, `other_resources` whether it declares images, samplers,
    uniform buffers, arrays of buffers and the like, `push_constant_bytes` the end of its push-constant block.
    """

    instructions: int
    capabilities: frozenset[int]
    entry_points: tuple[str, ...]
    bindings: frozenset[tuple[int, int]]
    other_resources: bool
    specialization: dict[int, SpecConstant]
    push_constant_bytes: int


def read_module(spirv: bytes) -> Module:
    """Read a SPIR-V module; raises InvalidArgument where it is none."""
    words = _words(spirv)
    try:
        return _read(words)
    except (LookupError, RecursionError):
        raise InvalidArgument("spirv: damaged, it refers to what it does not declare") from None


def _read(words: Sequence[int]) -> Module:
    tables = _Tables()
    count = 0
    for opcode, operands in _instructions(words):
        count += 1
        tables.take(opcode, operands)
    if not tables.entry_points:
        raise InvalidArgument("spirv: no compute entry point")
    placed = {i: (tables.sets.get(i, 0), b) for i, b in tables.bindings.items()}
    buffers = {i for i in placed if tables.is_buffer(i)}
    return Module(
        instructions=count,
        capabilities=frozenset(tables.capabilities),
        entry_points=tuple(tables.entry_points),
        bindings=frozenset(placed[i] for i in buffers),
        other_resources=len(buffers) < len(placed),
        specialization=tables.specialization(),
        push_constant_bytes=tables.push_constant_bytes(),
    )


def _words(spirv: bytes) -> Sequence[int]:
    if len(spirv) < 4 * _HEADER_WORDS or len(spirv) % 4:
        raise InvalidArgument(f"spirv: {len(spirv)} bytes are no SPIR-V module (words of 4 bytes, 20 bytes at least)")
    words = struct.unpack(f"<{len(spirv) // 4}I", spirv)
    if words[0] != _MAGIC:
        raise InvalidArgument(f"spirv: starts with {words[0]:#010x}, a SPIR-V module starts with {_MAGIC:#010x}")
    return words


def _instructions(words: Sequence[int]) -> Iterator[tuple[int, Sequence[int]]]:
    at = _HEADER_WORDS
    while at < len(words):
        length, opcode = words[at] >> 16, words[at] & 0xFFFF
        if length == 0 or at + length > len(words):
            raise InvalidArgument(f"spirv: damaged at word {at}")
        yield opcode, words[at + 1 : at + length]
        at += length


@dataclass
class _Tables:
    """The declarations met so far, by result id."""

    capabilities: set[int] = field(default_factory=set)
    entry_points: list[str] = field(default_factory=list)
    types: dict[int, tuple[int, Sequence[int]]] = field(default_factory=dict)
    constants: dict[int, int] = field(default_factory=dict)
    spec_types: dict[int, int] = field(default_factory=dict)
    spec_ids: dict[int, int] = field(default_factory=dict)
    variables: dict[int, tuple[int, int]] = field(default_factory=dict)
    sets: dict[int, int] = field(default_factory=dict)
    bindings: dict[int, int] = field(default_factory=dict)
    strides: dict[int, int] = field(default_factory=dict)
    members: dict[tuple[int, int, int], int] = field(default_factory=dict)
    sizes: dict[tuple[int, int], int] = field(default_factory=dict)

    def take(self, opcode: int, words: Sequence[int]) -> None:
        try:
            if _TYPE_BOOL <= opcode <= _TYPE_POINTER:
                self.types[words[0]] = (opcode, words[1:])
            elif opcode == _CAPABILITY:
                self.capabilities.add(words[0])
            elif opcode == _ENTRY_POINT and words[0] == _GL_COMPUTE:
                self.entry_points.append(_literal_string(words[2:]))
            elif opcode == _CONSTANT:
                self.constants[words[1]] = words[2]
            elif opcode in (_SPEC_TRUE, _SPEC_FALSE, _SPEC_CONSTANT):
                self.spec_types[words[1]] = words[0]
                self.constants[words[1]] = words[2] if opcode == _SPEC_CONSTANT else 0
            elif opcode == _VARIABLE:
                self.variables[words[1]] = (words[0], words[2])
            elif opcode == _DECORATE:
                self._decorate(words)
            elif opcode == _MEMBER_DECORATE and words[2] in (_OFFSET, _MATRIX_STRIDE):
                self.members[words[0], words[1], words[2]] = words[3]
        except IndexError:
            raise InvalidArgument(f"spirv: instruction {opcode} is cut short") from None

    def _decorate(self, words: Sequence[int]) -> None:
        tables = {
            _SPEC_ID: self.spec_ids,
            _ARRAY_STRIDE: self.strides,
            _BINDING: self.bindings,
            _DESCRIPTOR_SET: self.sets,
        }
        if words[1] in tables:
            tables[words[1]][words[0]] = words[2]

    def is_buffer(self, variable: int) -> bool:
        """Whether this is one storage buffer; an array of them takes other bindings."""
        pointer, storage = self.variables.get(variable, (0, -1))
        return storage == _STORAGE_BUFFER and self.types[self.types[pointer][1][1]][0] == _TYPE_STRUCT

    def specialization(self) -> dict[int, SpecConstant]:
        return {
            spec_id: self._scalar(self.spec_types[target])
            for target, spec_id in self.spec_ids.items()
            if target in self.spec_types
        }

    def _scalar(self, type_id: int) -> SpecConstant:
        opcode, words = self.types.get(type_id, (_TYPE_BOOL, ()))
        if opcode == _TYPE_FLOAT:
            return SpecConstant("float", words[0])
        if opcode == _TYPE_INT:
            return SpecConstant("int" if words[1] else "uint", words[0])
        return SpecConstant("bool", 32)

    def push_constant_bytes(self) -> int:
        blocks = [pointer for pointer, storage in self.variables.values() if storage == _PUSH_CONSTANT]
        return max((self._size(self.types[pointer][1][1]) for pointer in blocks), default=0)

    def _size(self, type_id: int, matrix_stride: int = 0) -> int:
        # Remembered, because structures nested twice each would double the work with every level.
        key = type_id, matrix_stride
        if key not in self.sizes:
            self.sizes[key] = self._measured(type_id, matrix_stride)
        return self.sizes[key]

    def _measured(self, type_id: int, matrix_stride: int) -> int:
        opcode, words = self.types[type_id]
        if opcode in (_TYPE_INT, _TYPE_FLOAT):
            return words[0] // 8
        if opcode == _TYPE_VECTOR:
            return self._size(words[0]) * words[1]
        if opcode == _TYPE_MATRIX:
            return (matrix_stride or self._size(words[0])) * words[1]
        if opcode == _TYPE_ARRAY:
            stride = self.strides.get(type_id) or self._size(words[0], matrix_stride)
            return stride * self.constants.get(words[1], 1)
        if opcode == _TYPE_STRUCT:
            return max((self._member_end(type_id, i, member) for i, member in enumerate(words)), default=0)
        return 8 if opcode == _TYPE_POINTER else 4

    def _member_end(self, struct_id: int, index: int, member: int) -> int:
        stride = self.members.get((struct_id, index, _MATRIX_STRIDE), 0)
        return self.members.get((struct_id, index, _OFFSET), 0) + self._size(member, stride)


def _literal_string(words: Sequence[int]) -> str:
    raw = struct.pack(f"<{len(words)}I", *words)
    return raw.split(b"\0", 1)[0].decode(errors="replace")
