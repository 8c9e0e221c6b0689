"""Messages between server and worker: a JSON head and raw bytes, with their lengths before them.

Nothing that a worker sends is executed or unpickled by the server: a worker's memory may have been damaged by a shader.
"""

from __future__ import annotations

import asyncio
import json
import struct
from dataclasses import dataclass
from typing import Any, BinaryIO

_LENGTH = struct.Struct("<I")
_LONGEST = 1 << 30


@dataclass(frozen=True)
class Message:
    """What is said (`head["do"]` to a worker, `head["say"]` from it), and bytes that go with it."""

    head: dict[str, Any]
    blobs: tuple[bytes, ...] = ()

    def packed(self) -> bytes:
        """The bytes that are sent."""
        head = json.dumps({**self.head, "blobs": [len(blob) for blob in self.blobs]}).encode()
        return b"".join([_LENGTH.pack(len(head)), head, *self.blobs])


def read(stream: BinaryIO) -> Message | None:
    """The next message of a blocking stream, or None where it ended."""
    prefix = stream.read(_LENGTH.size)
    if len(prefix) < _LENGTH.size:
        return None
    head = json.loads(stream.read(_length(prefix)))
    return Message(head, tuple(stream.read(size) for size in head.pop("blobs")))


async def read_from(reader: asyncio.StreamReader) -> Message | None:
    """The next message of a stream, or None where it ended or holds no message."""
    try:
        head = json.loads(await reader.readexactly(_length(await reader.readexactly(_LENGTH.size))))
        sizes = head.pop("blobs")
        if sum(sizes) > _LONGEST:
            return None
        return Message(head, tuple([await reader.readexactly(size) for size in sizes]))
    except (asyncio.IncompleteReadError, ConnectionError, ValueError, KeyError, TypeError):
        return None


def _length(prefix: bytes) -> int:
    length: int = _LENGTH.unpack(prefix)[0]
    if length > _LONGEST:
        raise ValueError(f"a message head of {length} bytes")
    return length
