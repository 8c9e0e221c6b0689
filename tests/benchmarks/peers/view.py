"""What every Python peer shares: the coefficients of a view, and the protocol on stdin and stdout."""

import json
import math
import sys
import time
from collections import namedtuple

View = namedtuple("View", "mu sine a b c d area det probability amplitude multiple roughness")
TECHNIQUES = ("cosine", "uniform", "ltc", "ltc-nonnegative", "cltc", "cltc-mis")


def view_of(theta, r, technique):
    """The numbers that do not change from sample to sample (EON paper, listings 2 and 4), as Python floats."""
    mu = math.cos(theta)
    e = 1 - mu
    a = 1 + r * (0.303392 + (-0.518982 + 0.111709 * mu) * mu + (-0.276266 + 0.335918 * mu) * r)
    b = r * (-1.16407 + 1.15859 * mu + (0.150815 - 0.150105 * mu) * r) / (mu * mu * mu - 1.43545)
    c = 1 + (0.20013 + (-0.506373 + 0.261777 * mu) * mu) * r
    d = r * (-6e-6 + (0.065466 + 0.475392 * e) * e) / (-0.0017372 + (-2.0725628 + e) * e)
    d = 0.0 if technique == "ltc-nonnegative" else d
    area = 0.5 + 0.5 / math.sqrt(1 + d * d) if technique.startswith("cltc") else 1.0
    fit = 0.162925 + mu * (-0.372058 + (0.538233 - 0.290822 * mu) * mu)
    probability = r**0.1 * fit if technique == "cltc-mis" else 0.0
    amplitude = 1 / (1 + 0.287793409210806 * r)
    s = math.sqrt((1 - mu) * (1 + mu))
    deficit = 0.90412966012823 * mu * mu / (1 + s)
    deficit += s * (math.asin(mu) + s * mu - 2 / 3 * mu * (1 + s + s * s) / (1 + s))
    multiple = amplitude * r * 0.149794500641183 * deficit
    return View(mu, math.sin(theta), a, b, c, d, area, c * (a - b * d), probability, amplitude, multiple, r)


def serve(compute):
    """Answer lines "technique roughness samples seed angle..." with the seconds taken and, for each angle, the sums of
    (weight - 1)^k for k = 1 to 4 and the largest weight, as compute(views, technique, samples, seed) gives them."""
    for line in sys.stdin:
        technique, roughness, samples, seed, *angles = line.split()
        views = [view_of(float(angle), float(roughness), technique) for angle in angles]
        begin = time.perf_counter()
        powers = compute(views, technique, int(samples), int(seed))
        seconds = time.perf_counter() - begin
        print(json.dumps({"seconds": seconds, "powers": [[float(x) for x in row] for row in powers]}), flush=True)
