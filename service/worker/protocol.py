"""Messages between server and worker: a JSON head and raw bytes, with the lengths of both before them.

Nothing that a worker sends is executed or unpickled by the server: a worker's memory may have been damaged by a shader.
"""

from __future__ import annotations

import json
import socket
import struct
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

_LENGTHS = struct.Struct("<II")
_LONGEST = 1 << 30


@dataclass(frozen=True)
class Message:
    """What is said (`head["do"]` to a worker, `head["say"]` from it), and bytes that go with it."""

    head: dict[str, Any]
    blobs: tuple[bytes, ...] = ()

    def packed(self) -> bytes:
        """The bytes that are sent."""
        sizes = [len(blob) for blob in self.blobs]
        head = json.dumps({**self.head, "blobs": sizes}).encode()
        return b"".join([_LENGTHS.pack(len(head), sum(sizes)), head, *self.blobs])


class Unpacker:
    """Messages out of bytes that arrive in pieces of any size."""

    def __init__(self) -> None:
        self._bytes = bytearray()

    def feed(self, piece: bytes) -> Iterator[Message]:
        """Every message that this piece completes. Raises ValueError or TypeError where the bytes are none."""
        self._bytes += piece
        while len(self._bytes) >= _LENGTHS.size:
            head, blobs = _lengths(self._bytes)
            end = _LENGTHS.size + head + blobs
            if len(self._bytes) < end:
                return
            yield _unpacked(bytes(self._bytes[_LENGTHS.size : end]), head)
            del self._bytes[:end]


def receive(connection: socket.socket) -> Message | None:
    """Wait for the next message; None where the other side has ended."""
    prefix = _exactly(connection, _LENGTHS.size)
    if len(prefix) < _LENGTHS.size:
        return None
    head, blobs = _lengths(prefix)
    content = _exactly(connection, head + blobs)
    return _unpacked(content, head) if len(content) == head + blobs else None


def _exactly(connection: socket.socket, count: int) -> bytes:
    """So many bytes, or fewer where the stream ends before."""
    pieces: list[bytes] = []
    while count and (piece := connection.recv(count, socket.MSG_WAITALL)):
        pieces.append(piece)
        count -= len(piece)
    return b"".join(pieces)


def _lengths(prefix: bytes | bytearray) -> tuple[int, int]:
    """Bytes of the head and of all blobs."""
    head, blobs = _LENGTHS.unpack_from(prefix)
    if head + blobs > _LONGEST:
        raise ValueError(f"a message of {head + blobs} bytes")
    return head, blobs


def _unpacked(content: bytes, length: int) -> Message:
    head = json.loads(content[:length])
    blobs: list[bytes] = []
    for size in head.pop("blobs"):
        blobs.append(content[length : length + size])
        length += size
    return Message(head, tuple(blobs))
