"""Checkpoints of a run as bytes: how many launches they hold, and the sums of every cell."""

from __future__ import annotations

import struct

import numpy as np

from service.sampling import CellSums, Checkpoint

_HEAD = struct.Struct("<3q")
_COUNTS = ("drawn", "zero", "nonfinite", "negative", "first_bad")
_REALS = ("shift", "largest")


def size(checkpoint: Checkpoint) -> int:
    """Bytes that `pack` would give."""
    return _HEAD.size + 8 * (len(_COUNTS) + len(_REALS) + 4) * len(checkpoint.sums.drawn)


def pack(checkpoint: Checkpoint) -> bytes:
    """The checkpoint as little-endian 64-bit words."""
    sums = checkpoint.sums
    columns = [getattr(sums, name) for name in (*_COUNTS, *_REALS)]
    head = _HEAD.pack(checkpoint.launches, sums.device_ns, len(sums.drawn))
    return b"".join([head, *(column.tobytes() for column in columns), sums.powers.tobytes()])


def unpack(content: bytes) -> Checkpoint:
    """The checkpoint that `pack` wrote."""
    launches, device_ns, cells = _HEAD.unpack_from(content)
    words = np.frombuffer(content, "<i8", offset=_HEAD.size).reshape(-1, cells).copy()
    counts, reals = words[: len(_COUNTS)], words[len(_COUNTS) :].view("<f8")
    sums = CellSums(
        **dict(zip(_COUNTS, counts, strict=True)),
        **dict(zip(_REALS, reals[: len(_REALS)], strict=True)),
        powers=reals[len(_REALS) :],
        device_ns=device_ns,
    )
    return Checkpoint(launches, sums)
