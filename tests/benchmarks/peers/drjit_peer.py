"""EON statistics in Dr.Jit's LLVM backend: one recorded loop over many lanes, each of which draws its own samples.

Far faster than arrays of all samples, because nothing but the sums leaves the registers. Kernels are cached by shape.
"""

import drjit as dr
import numpy as np
from drjit.llvm import Float, Int32, UInt32
from view import serve

LANES = 1024  # for each angle


def circle(u):
    return tuple(reversed(dr.sincos(u * (2 * np.pi))))


def deficit(m):
    s = dr.sqrt((1 - m) * (1 + m))
    inverse = 1 / (1 + s)
    return 0.90412966 * m * m * inverse + s * (dr.asin(m) + s * m - 2 / 3 * m * (1 + s + s * s) * inverse)


def weight(v, technique, u1, u2):
    cosine, sine = circle(u2)
    if technique == "cosine":
        x, z, over = dr.sqrt(1 - u1) * cosine, dr.sqrt(u1), np.pi
    elif technique == "uniform":
        x, z, over = dr.sqrt((1 - u1) * (1 + u1)) * cosine, u1, 2 * np.pi * u1
    else:
        x, z, over = lobe(v, technique, u1, cosine, sine)
    z = dr.minimum(z, 1)
    s = x * v.sine
    ratio = dr.select(s > 0, s / dr.maximum(z, v.mu), s)
    return (dr.inv_pi * v.amplitude * (1 + v.roughness * ratio) + v.multiple * deficit(z)) * over


def lobe(v, technique, u1, cosine, sine):
    mixed, clipped = technique == "cltc-mis", technique.startswith("cltc")
    first = u1
    if mixed:
        pick = u1 < v.probability
        first = dr.select(pick, u1 / v.probability, (u1 - v.probability) / (1 - v.probability))
    radius = dr.sqrt(dr.maximum(1 - first, 0))
    hx, hy, hz = radius * cosine, radius * sine, dr.sqrt(first)
    if clipped:
        width = dr.sqrt(hx * hx + first)
        gap = dr.select(hx > 0, first / (width + hx), width - hx)  # width - hx without cancellation
        squeezed = width * (1 - v.area) + v.area * hx
        hz = dr.sqrt(v.area * gap * dr.maximum(width + squeezed, 0))
        hx = dr.select(v.d > 0, squeezed, -squeezed)
    x, y, z = v.a * hx + v.b * hz, v.c * hy, v.d * hx + hz
    squared = x * x + y * y + z * z
    inverse = dr.rsqrt(squared)
    x, y, z = x * inverse, y * inverse, z * inverse
    if not mixed:
        pdf = dr.inv_pi * hz / v.area * squared / (inverse * v.det)
        z = dr.maximum(z, 0)
        return x, z, dr.select(pdf > 0, z / pdf, 0)
    up = dr.sqrt((1 - first) * (1 + first))
    x, y, z = dr.select(pick, up * cosine, x), dr.select(pick, up * sine, y), dr.maximum(dr.select(pick, first, z), 0)
    px, py, pz = v.c * (x - v.b * z), (v.a - v.b * v.d) * y, v.c * (v.a * z - v.d * x)
    q = v.det / (px * px + py * py + pz * pz)
    density = (1 - v.probability) / v.area * dr.inv_pi * q * q * dr.maximum(pz, 0)
    return x, z, z / (v.probability * (0.5 * dr.inv_pi) + density)


def two_samples(i, lane, seed):
    """(u1, u2) twice from one hash, as samplerscope forms them: u1 of 40 bits, u2 of 24."""
    m, k = 1664525, 1013904223
    a, b, c, d = i * m + k, lane * m + k, seed * m + k, UInt32(k)
    a += b * d
    b += c * a
    c += a * b
    d += b * c
    a, b, c, d = a ^ (a >> 16), b ^ (b >> 16), c ^ (c >> 16), d ^ (d >> 16)
    a += b * d
    b += c * a
    c += a * b
    d += b * c
    return unit_square(a, b), unit_square(c, d)


def unit_square(a, b):
    u1 = Float(Int32(a >> 8)) * 2**-24 + Float(Int32(((a & 255) << 8) | (b & 255))) * 2**-40
    return dr.minimum(u1, 1 - 2**-24), Float(Int32(b >> 8)) * 2**-24


def compute(views, technique, samples, seed):
    lane = dr.arange(UInt32, len(views) * LANES)
    columns = [Float(np.repeat(np.array(column, np.float32), LANES)) for column in zip(*views, strict=True)]
    v = type(views[0])(*columns)
    seed, count = dr.opaque(UInt32, seed), dr.opaque(UInt32, samples // (2 * LANES))

    def body(i, s1, s2, s3, s4, largest):
        for u in two_samples(i, lane, seed):
            w = weight(v, technique, *u)
            e = w - 1
            s1, s2, s3, s4 = s1 + e, s2 + e * e, s3 + e * e * e, s4 + (e * e) * (e * e)
            largest = dr.maximum(largest, w)
        return i + 1, s1, s2, s3, s4, largest

    start = (UInt32(0), *(dr.zeros(Float, len(lane)) for _ in range(5)))
    _, *sums = dr.while_loop(start, lambda i, *_: i < count, body)
    dr.eval(sums)
    table = np.stack([s.numpy().reshape(-1, LANES) for s in sums]).astype(float)
    return np.concatenate([table[:4].sum(axis=2), table[4:].max(axis=2)]).T


serve(compute)
