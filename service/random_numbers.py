"""The random numbers of a cell: a function of the seed, the view angle's value and the sample index, of nothing else.

The shader draws them (shaders/common/random.glsl); here are the key of a cell, formed on the host, and the same numbers
in NumPy, for replays and tests.
"""

from __future__ import annotations

import hashlib
import struct

import numpy as np
from numpy.typing import NDArray

BLOCK_SAMPLES = 16384
"""Sample indices in one block; the same constant stands in shaders/statistics.comp."""


def cell_key(seed: int, theta_o_deg: float, phi_o_deg: float = 0.0) -> tuple[int, int]:
    """The 64-bit key of a view, as two 32-bit words. Equal views share it, whatever model or technique looks at
    them.
    """
    digest = hashlib.blake2b(struct.pack("<Qdd", seed, theta_o_deg + 0.0, phi_o_deg + 0.0), digest_size=8).digest()
    low, high = struct.unpack("<II", digest)
    return low, high


def random_pairs(key: tuple[int, int], indices: NDArray[np.uint64]) -> NDArray[np.float32]:
    """(u1, u2) of sample indices, shape (n, 2), bit for bit those of the shader."""
    counters = np.empty((4, len(indices)), np.uint32)
    counters[0] = indices % BLOCK_SAMPLES
    counters[1] = indices // BLOCK_SAMPLES
    counters[2], counters[3] = key
    bits = (pcg4d(counters) >> np.uint32(8)).astype(np.float32)
    u1 = bits[0] * np.float32(2.0**-24) + bits[1] * np.float32(2.0**-48)
    return np.stack([np.minimum(u1, np.float32(1 - 2.0**-24)), bits[2] * np.float32(2.0**-24)], axis=1)


def pcg4d(v: NDArray[np.uint32]) -> NDArray[np.uint32]:
    """The pcg4d hash of columns of four words (Jarzynski and Olano, JCGT 9(3), 2020); shape (4, n)."""
    v = v * np.uint32(1664525) + np.uint32(1013904223)
    _mix(v)
    v ^= v >> np.uint32(16)
    _mix(v)
    return v


def _mix(v: NDArray[np.uint32]) -> None:
    v[0] += v[1] * v[3]
    v[1] += v[2] * v[0]
    v[2] += v[0] * v[1]
    v[3] += v[1] * v[2]
