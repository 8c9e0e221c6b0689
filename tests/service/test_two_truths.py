"""The two float64 truths of the catalogue against each other: the GLSL widened to double, and the Python reference.

They share no code. Both are asked at the same unrounded inputs, at directions that the technique itself draws, so that
densities are compared where they lie, in lobes of any width.
"""

import math

import numpy as np
import pytest

from service.catalogue import load_catalogue
from service.inputs import inner_value
from service.probe import Probe
from service.reference import load_model, load_technique

CATALOGUE = load_catalogue()
PAIRS = [(model, technique) for model in CATALOGUE.models for technique in CATALOGUE.techniques_for(model)]
DRAWN = 400
FAINT = 1e-250
"""Values below it come close to the end of float64's range, where digits are lost."""

TOLERANCE = 1e-9
"""A lobe of width m multiplies the rounding of a direction, 1e-16, by up to sqrt(x)/(m cos) for exp(-x): 1e-10 at slope
0.001, and as much at exponents of 10^6."""


def view(theta_deg, phi):
    theta = math.radians(theta_deg)
    return np.array([math.sin(theta) * math.cos(phi), math.sin(theta) * math.sin(phi), math.cos(theta)])


def disagreement(probe, values, wo, u):
    """The largest relative differences of BRDF and both densities, between the truths."""
    found = probe.draw(wo, u, np.array([list(values.values())]), "double")
    brdf = load_model(probe.model.name).brdf(found.wi, wo, values)
    density = load_technique(probe.technique.name).density(wo, found.wi, values)
    # Next to the horizon cos is what rounding leaves of it; the weight knows it through the product alone.
    pairs = [
        (found.brdf, brdf, found.wi[:, 2] > 1e-6),
        (found.direction_pdf, density, True),
        (found.pdf, density, True),
    ]
    out = []
    for one, other, counts in pairs:
        counts = counts & (np.maximum(np.abs(one), np.abs(other)) > FAINT)
        out.append(float(np.max(np.abs(one - other)[counts] / np.abs(other[counts]), initial=0.0)))
    return out, found


@pytest.mark.parametrize(("model", "technique"), PAIRS)
def test_the_widened_catalogue_and_the_python_reference_agree(engine, model, technique):
    """At random parameters, down to slopes of 0.001 and up to exponents of 10^6, and views up to 89 degrees."""
    probe, rng = Probe(engine, CATALOGUE.model(model), CATALOGUE.technique(technique)), np.random.default_rng(1)
    for _ in range(5):
        values = {name: inner_value(p, rng.random()) for name, p in probe.declared.items()}
        off, _ = disagreement(probe, values, view(rng.uniform(0, 89), rng.uniform(0, 6)), rng.random((DRAWN, 2)))
        assert max(off) < TOLERANCE


NARROW = {"mx": 0.01, "my": 0.01, "mx1": 0.01, "my1": 0.01, "mx2": 0.01, "my2": 0.01, "nu": 2e4, "nv": 2e4, "n": 2e4}
GLOSSY = [pair for pair in PAIRS if not NARROW.keys().isdisjoint(CATALOGUE.models[pair[0]].head.parameters)]


@pytest.mark.parametrize(("model", "technique"), [pair for pair in GLOSSY if pair[1] not in ("cosine", "uniform")])
def test_the_truths_agree_in_a_narrow_lobe_seen_from_85_degrees(engine, model, technique):
    """Slope 0.01, or the exponent 2/m^2 = 2e4: what the quadrature of narrow lobes rests on."""
    probe, rng = Probe(engine, CATALOGUE.model(model), CATALOGUE.technique(technique)), np.random.default_rng(2)
    values = {name: NARROW.get(name, p.default) for name, p in probe.declared.items()}
    off, found = disagreement(probe, values, view(85.0, 0.5), rng.random((DRAWN, 2)))
    assert max(off) < 1e-11  # sqrt(x)/(m cos) = 5e3 roundings of 1e-16, and the sums behind them
    assert np.quantile(found.pdf, 0.75) > 100  # the lobe is what was compared, of a mixture in half of the directions
