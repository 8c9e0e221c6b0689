"""EON statistics in Numba: parallel over angles, fastmath, everything float32 so that LLVM vectorizes the inner loop;
sine, cosine and arc sine are polynomials, because calls into the C library would keep it scalar."""

import numba as nb
import numpy as np
from numba import njit, prange
from view import TECHNIQUES, serve

F = np.float32
BLOCK = 1024
PI, INV_PI, TWO_PI = F(np.pi), F(1 / np.pi), F(2 * np.pi)
ZERO, HALF, ONE, TWO = F(0), F(0.5), F(1), F(2)
fast = {"fastmath": True, "inline": "always", "error_model": "numpy"}


@njit(**fast)
def arcsine(x):
    large = x > HALF
    y = np.sqrt(HALF * (ONE - x)) if large else x
    t = y * y
    p = F(4.2163199e-2) * t + F(2.4181311e-2)
    p = (p * t + F(4.5470026e-2)) * t + F(7.4953003e-2)
    y = y + y * t * (p * t + F(1.6666675e-1))
    return F(1.5707963) - TWO * y if large else y


@njit(**fast)
def deficit(m):
    s = np.sqrt((ONE - m) * (ONE + m))
    inverse = ONE / (ONE + s)
    return F(0.90412966) * m * m * inverse + s * (arcsine(m) + s * m - F(2 / 3) * m * (ONE + s + s * s) * inverse)


@njit(**fast)
def circle(u):
    quarter = np.floor(F(4) * u + HALF)
    a = (u - F(0.25) * quarter) * TWO_PI
    t = a * a
    s = a + a * t * ((F(-1.9515296e-4) * t + F(8.3321609e-3)) * t - F(1.6666655e-1))
    c = ONE - HALF * t + t * t * ((F(2.4433157e-5) * t - F(1.3887316e-3)) * t + F(4.1666646e-2))
    q = np.int32(quarter)
    odd = (q & np.int32(1)) != 0
    x, y = (s, c) if odd else (c, s)
    return (-x if ((q + np.int32(1)) & np.int32(2)) != 0 else x), (-y if (q & np.int32(2)) != 0 else y)


@njit(**fast)
def weight(v, technique, u1, u2):
    mu, sine, a, b, c, d, area, det, probability, amplitude, multiple, r = v
    cosine_phi, sine_phi = circle(u2)
    if technique == 0:
        z = np.sqrt(u1)
        x = np.sqrt(ONE - u1) * cosine_phi
        over = PI
    elif technique == 1:
        z = u1
        x = np.sqrt((ONE - u1) * (ONE + u1)) * cosine_phi
        over = TWO_PI * z
    else:
        pick = technique == 5 and u1 < probability
        first = u1
        if technique == 5:
            first = u1 / probability if pick else (u1 - probability) / (ONE - probability)
        radius = np.sqrt(max(ONE - first, ZERO))
        hx, hy, hz = radius * cosine_phi, radius * sine_phi, np.sqrt(first)
        if technique >= 4:
            width = np.sqrt(hx * hx + first)
            gap = first / (width + hx) if hx > ZERO else width - hx  # width - hx without cancellation
            squeezed = width * (ONE - area) + area * hx
            hz = np.sqrt(area * gap * max(width + squeezed, ZERO))
            hx = squeezed if d > ZERO else -squeezed
        x, y, z = a * hx + b * hz, c * hy, d * hx + hz
        squared = x * x + y * y + z * z
        inverse = ONE / np.sqrt(squared)
        x, y, z = x * inverse, y * inverse, z * inverse
        if technique == 5:
            up = np.sqrt((ONE - first) * (ONE + first))
            x, y = (up * cosine_phi, up * sine_phi) if pick else (x, y)
            z = max(first if pick else z, ZERO)
            px, py, pz = c * (x - b * z), (a - b * d) * y, c * (a * z - d * x)
            q = det / (px * px + py * py + pz * pz)
            over = z / (probability * F(0.15915494) + (ONE - probability) / area * INV_PI * q * q * max(pz, ZERO))
        else:
            pdf = INV_PI * hz / area * squared / (inverse * det)
            z = max(z, ZERO)
            over = z / pdf if pdf > F(1e-30) else ZERO
    z = min(z, ONE)
    s = x * sine
    ratio = s / max(z, mu) if s > ZERO else s
    return (INV_PI * amplitude * (ONE + r * ratio) + multiple * deficit(z)) * over


@njit(**fast)
def madd(a, b, c):
    """a + b c modulo 2^32; Numba widens every product of 32-bit integers to 64 bits, the cast undoes it."""
    return np.uint32(a + np.uint32(b * c))


@njit(**fast)
def pair(i, block, angle, seed):
    m, k = np.uint32(1664525), np.uint32(1013904223)
    a, b, c, d = madd(k, i, m), madd(k, block, m), madd(k, angle, m), madd(k, seed, m)
    a = madd(a, b, d)
    b = madd(b, c, a)
    c = madd(c, a, b)
    d = madd(d, b, c)
    a = np.uint32(a ^ (a >> np.uint32(16)))
    b = np.uint32(b ^ (b >> np.uint32(16)))
    c = np.uint32(c ^ (c >> np.uint32(16)))
    d = np.uint32(d ^ (d >> np.uint32(16)))
    a = madd(a, b, d)
    b = madd(b, c, a)
    c = madd(c, a, b)
    high, low, other = np.int32(a >> np.uint32(8)), np.int32(b >> np.uint32(8)), np.int32(c >> np.uint32(8))
    return min(F(high) * F(2**-24) + F(low) * F(2**-48), F(1 - 2**-24)), F(other) * F(2**-24)


def compiled(technique):
    """The whole run for one technique, a constant of the code."""
    number = TECHNIQUES.index(technique)

    @njit(parallel=True, fastmath=True, error_model="numpy")
    def run(views, samples, seed, out):
        for at in prange(len(views)):
            row = views[at]
            v = (row[0], row[1], row[2], row[3], row[4], row[5], row[6], row[7], row[8], row[9], row[10], row[11])
            t1, t2, t3, t4, top = 0.0, 0.0, 0.0, 0.0, ZERO
            for block in range((samples + BLOCK - 1) // BLOCK):
                s1, s2, s3, s4, largest = ZERO, ZERO, ZERO, ZERO, ZERO
                for i in range(np.uint32(min(BLOCK, samples - block * BLOCK))):
                    u1, u2 = pair(np.uint32(i), np.uint32(block), np.uint32(at), np.uint32(seed))
                    w = weight(v, number, u1, u2)
                    e = w - ONE
                    s1 += e
                    s2 += e * e
                    s3 += e * e * e
                    s4 += (e * e) * (e * e)
                    largest = max(largest, w)
                t1 += s1
                t2 += s2
                t3 += s3
                t4 += s4
                top = max(top, largest)
            out[at, 0], out[at, 1], out[at, 2], out[at, 3], out[at, 4] = t1, t2, t3, t4, top

    return run


RUNS = {technique: compiled(technique) for technique in TECHNIQUES}
nb.config.THREADING_LAYER = "workqueue"


def compute(views, technique, samples, seed):
    out = np.empty((len(views), 5))
    RUNS[technique](np.array(views, F), samples, seed, out)
    return out


serve(compute)
