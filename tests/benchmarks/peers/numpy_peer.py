"""EON statistics in NumPy: float32, chunks that stay in the second-level cache, in-place where it pays, one thread a
core (NumPy releases the interpreter's lock). Random numbers are SFC64's, the fastest of its generators."""

import os
from concurrent.futures import ThreadPoolExecutor

import numpy as np
from view import serve

CHUNK = 1 << 14
F = np.float32
PI = F(np.pi)


def deficit(m):
    s = np.sqrt((1 - m) * (1 + m))
    inverse = 1 / (1 + s)
    t = np.arcsin(m)
    t += s * m
    t -= F(2 / 3) * m * (1 + s + s * s) * inverse
    t *= s
    t += F(0.90412966) * m * m * inverse
    return t


def weights(v, technique, u1, u2):
    """f cos / pdf of a chunk."""
    phi = F(2 * np.pi) * u2
    if technique in ("cosine", "uniform"):
        z = np.sqrt(u1) if technique == "cosine" else u1
        x = np.sqrt(1 - u1 if technique == "cosine" else (1 - u1) * (1 + u1)) * np.cos(phi)
        over_pdf = PI if technique == "cosine" else 2 * PI * z
    else:
        x, z, over_pdf = lobe(v, technique, u1, phi)
    z = np.minimum(z, F(1))
    s = x * v.sine
    ratio = np.where(s > 0, s / np.maximum(z, v.mu), s)
    return (F(1 / np.pi) * v.amplitude * (1 + v.roughness * ratio) + v.multiple * deficit(z)) * over_pdf


def lobe(v, technique, u1, phi):
    pick, first = None, u1
    if technique == "cltc-mis":
        pick = u1 < v.probability
        first = np.where(pick, u1 / v.probability, (u1 - v.probability) / (1 - v.probability))
    cosine, sine = np.cos(phi), np.sin(phi)
    radius = np.sqrt(np.maximum(1 - first, 0))
    hx, hy, hz = radius * cosine, radius * sine, np.sqrt(first)
    if technique.startswith("cltc"):
        width = np.sqrt(hx * hx + first)
        gap = np.where(hx > 0, first / (width + hx), width - hx)  # width - hx without cancellation
        squeezed = width * (1 - v.area) + v.area * hx
        hz = np.sqrt(v.area * gap * np.maximum(width + squeezed, 0))
        hx = squeezed if v.d > 0 else -squeezed
    x, y, z = v.a * hx + v.b * hz, v.c * hy, v.d * hx + hz
    squared = x * x + y * y + z * z
    inverse = 1 / np.sqrt(squared)
    x, y, z = x * inverse, y * inverse, z * inverse
    if pick is None:
        pdf = F(1 / np.pi) / v.area * hz * squared / (inverse * v.det)
        above = np.maximum(z, 0)
        return x, above, np.where(pdf > 0, above / pdf, F(0))
    up = np.sqrt((1 - first) * (1 + first))
    x, y, z = np.where(pick, up * cosine, x), np.where(pick, up * sine, y), np.maximum(np.where(pick, first, z), 0)
    pz = v.c * (v.a * z - v.d * x)
    q = v.det / ((v.c * (x - v.b * z)) ** 2 + ((v.a - v.b * v.d) * y) ** 2 + pz * pz)
    pdf = v.probability * F(1 / (2 * np.pi)) + (1 - v.probability) / v.area * F(1 / np.pi) * q * q * np.maximum(pz, 0)
    return x, z, z / pdf


def one_angle(v, technique, samples, seed):
    v = type(v)(*(F(x) for x in v))
    random = np.random.Generator(np.random.SFC64(seed))
    total, largest = np.zeros(4), 0.0
    for first in range(0, samples, CHUNK):
        u = random.random((2, min(CHUNK, samples - first)), dtype=F)
        with np.errstate(divide="ignore", invalid="ignore"):  # in branches that are not taken
            w = weights(v, technique, *u)
        e = w - F(1)
        square = e * e
        total += e.sum(dtype=float), square.sum(dtype=float), (square @ e), (square @ square)
        largest = max(largest, float(w.max()))
    return [*total, largest]


def compute(views, technique, samples, seed):
    seeds = np.random.SeedSequence(seed).spawn(len(views))
    return list(POOL.map(lambda job: one_angle(job[0], technique, samples, job[1]), zip(views, seeds, strict=True)))


POOL = ThreadPoolExecutor(len(os.sched_getaffinity(0)))
serve(compute)
