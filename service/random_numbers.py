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
    """The 64-bit key of a view, as two 32-bit words: the same whatever model and technique look from there."""
    digest = hashlib.blake2b(struct.pack("<Qdd", seed, theta_o_deg + 0.0, phi_o_deg + 0.0), digest_size=8).digest()
    low, high = struct.unpack("<II", digest)
    return low, high


def random_pairs(key: tuple[int, int], indices: NDArray[np.uint64]) -> NDArray[np.float32]:
    """(u1, u2) of sample indices, shape (n, 2), bit for bit those of the shader. Two samples share a hash."""
    counters = np.empty((4, len(indices)), np.uint32)
    counters[0] = indices % BLOCK_SAMPLES // 2
    counters[1] = indices // BLOCK_SAMPLES
    counters[2], counters[3] = key
    bits = pcg4d(counters)
    a, b = np.where(indices % 2 == 0, bits[:2], bits[2:])
    low = ((a & np.uint32(255)) << np.uint32(8) | b & np.uint32(255)).astype(np.float32)
    u1 = (a >> np.uint32(8)).astype(np.float32) * np.float32(2.0**-24) + low * np.float32(2.0**-40)
    u2 = (b >> np.uint32(8)).astype(np.float32) * np.float32(2.0**-24)
    return np.stack([np.minimum(u1, np.float32(1 - 2.0**-24)), u2], axis=1)


def replicate_key(seed: int, replicate: int, theta_o_deg: float, phi_o_deg: float = 0.0) -> tuple[int, int]:
    """The key of a view in one of several independent runs; replicates of one view share no random numbers."""
    content = struct.pack("<QQdd", seed, replicate, theta_o_deg + 0.0, phi_o_deg + 0.0)
    low, high = struct.unpack("<II", hashlib.blake2b(content, digest_size=8, person=b"replicate").digest())
    return low, high


def scrambled_sobol_pairs(key: tuple[int, int], indices: NDArray[np.uint64]) -> NDArray[np.float32]:
    """(u1, u2) of the Owen-scrambled Sobol' sequence, shape (n, 2), bit for bit those of shaders/common/sobol.glsl."""
    index = indices.astype(np.uint32)
    columns = [_reversed_bits(_laine_karras(x, seed)) for x, seed in zip((index, _pascal(index)), key, strict=True)]
    return np.stack([_unit_interval(column) for column in columns], axis=1)


def _laine_karras(x: NDArray[np.uint32], seed: int) -> NDArray[np.uint32]:
    x = x ^ x * np.uint32(0x3D20ADEA)
    x = (x + np.uint32(seed)) * np.uint32((seed >> 16) | 1)
    x ^= x * np.uint32(0x05526C56)
    x ^= x * np.uint32(0x53A22864)
    return x


def _pascal(n: NDArray[np.uint32]) -> NDArray[np.uint32]:
    for shift, mask in ((1, 0x55555555), (2, 0x33333333), (4, 0x0F0F0F0F), (8, 0x00FF00FF), (16, 0x0000FFFF)):
        n = n ^ ((n >> np.uint32(shift)) & np.uint32(mask))
    return n


def _reversed_bits(x: NDArray[np.uint32]) -> NDArray[np.uint32]:
    for shift, mask in ((1, 0x55555555), (2, 0x33333333), (4, 0x0F0F0F0F), (8, 0x00FF00FF), (16, 0x0000FFFF)):
        x = ((x >> np.uint32(shift)) & np.uint32(mask)) | ((x & np.uint32(mask)) << np.uint32(shift))
    return x


def _unit_interval(x: NDArray[np.uint32]) -> NDArray[np.float32]:
    high, low = (x >> np.uint32(8)).astype(np.float32), (x & np.uint32(255)).astype(np.float32)
    u = high * np.float32(2.0**-24) + low * np.float32(2.0**-32)
    return np.minimum(u, np.float32(1 - 2.0**-24))


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
