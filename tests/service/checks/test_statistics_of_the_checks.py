"""The mathematics behind the checks, on cases with known answers: quadrature, chi-square, tails."""

import math
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from scipy import stats

from service.checks.binning import EXPECTED_AT_LEAST, chi_square, partition, upper_tail
from service.checks.effort import FULL
from service.checks.sphere_quadrature import Known, coordinates, cut, directions, grid, integrate
from service.checks.tails import FITTED, INFINITE_VARIANCE, KEPT, UNBOUNDED, check_supremum, follow, tail_index
from service.inputs import Cells


@pytest.mark.parametrize("freedom", [1, 2, 10, 63, 255, 1000])
def test_the_tail_of_chi_square_is_that_of_scipy(freedom):
    for quantile in (0.9, 0.5, 1e-2, 1e-7, 1e-12):
        statistic = stats.chi2.isf(quantile, freedom)
        assert upper_tail(statistic, freedom) == pytest.approx(stats.chi2.sf(statistic, freedom), rel=1e-8)


def test_chi_square_of_true_expectations_is_uniform():
    """600 runs of a cosine hemisphere in 64 bins; Kolmogorov's test would fail one seed in 1,000."""
    rng = np.random.default_rng(5)
    probabilities = []
    for _ in range(600):
        t, phi = 1 - np.sqrt(rng.random(6000)), 2 * np.pi * rng.random(6000)
        tree = partition(t, phi, 2000, 6)
        z0, z1 = 1 - tree.boxes[:, 1].clip(max=1), 1 - tree.boxes[:, 0].clip(max=1)
        expected = 4000 * (z1**2 - z0**2) * (tree.boxes[:, 3] - tree.boxes[:, 2]) / (2 * np.pi)
        probabilities.append(chi_square(tree.hits, expected, 0 * expected).probability)
    assert stats.kstest(probabilities, "uniform").pvalue > 1e-3


def test_bins_with_few_expected_hits_are_pooled_and_none_is_lost():
    rng = np.random.default_rng(0)
    expected = np.concatenate([rng.uniform(0, 3, 100), [50.0, 500.0]])
    test = chi_square(expected.copy(), expected, 0 * expected)
    assert test.statistic == pytest.approx(0, abs=1e-12)
    assert 2 <= test.freedom + 1 <= 2 + expected[:100].sum() / EXPECTED_AT_LEAST
    doubled = chi_square(2 * expected, expected, 0 * expected)
    assert doubled.statistic == pytest.approx(expected.sum(), rel=1e-9)


def test_bins_whose_expectation_is_not_certain_take_no_part():
    """What the quadrature did not see is no evidence against the sampler; what it did see still is."""
    expected, unsure = np.full(64, 400.0), np.zeros(64)
    hits = expected.copy()
    hits[:8] = 3 * expected[:8]
    unsure[:8] = 800.0
    test = chi_square(hits, expected, unsure)
    assert (test.statistic, test.freedom) == (0.0, 56)
    assert test.left_out == pytest.approx(8 * 1200 / (8 * 1200 + 56 * 400))
    hits[8:] = np.where(np.arange(56) % 2, 320.0, 480.0)
    assert chi_square(hits, expected, unsure).probability < 1e-9


def test_chi_square_of_some_bins_alone_stays_below_its_limit():
    """400 runs of 64 bins of which half take part: no more small probabilities than a uniform law gives, up to chance.

    A count of 400 below 0.1 exceeds 65 by chance once in 3,000.
    """
    rng = np.random.default_rng(6)
    share = rng.dirichlet(np.full(64, 3.0))
    expected = 40_000 * share
    unsure = np.where(np.arange(64) < 32, 1e4, 0.0)
    below = sum(
        chi_square(rng.multinomial(40_000, share).astype(float), expected, unsure).probability < 0.1 for _ in range(400)
    )
    assert below <= 65


SPOT = np.array([0.48, -0.36, 0.8])
SHARPNESS = 1e9


def spot_and_sphere(wi):
    """Half of the density uniform on the sphere, half a von Mises-Fisher lobe 3e-5 in width."""
    off = 0.5 * np.sum((wi - SPOT) ** 2, axis=1)
    return 0.5 / (4 * np.pi) + 0.5 * SHARPNESS / (2 * np.pi) * np.exp(-SHARPNESS * off)


def drawn_from_spot_and_sphere(count, rng):
    wi = rng.normal(size=(count, 3)) * np.where(rng.random(count) < 0.5, 1.0, SHARPNESS**-0.5)[:, None]
    wi[np.linalg.norm(wi, axis=1) < 1e-3] += SPOT
    return wi / np.linalg.norm(wi, axis=1, keepdims=True)


def spot_integral(budget, *, told):
    wi = drawn_from_spot_and_sphere(2000, np.random.default_rng(4))
    t, phi = coordinates(wi)
    bins = np.floor(np.minimum(t, 1.9999) * 8).astype(np.int64) * 16 + np.floor(phi / (2 * np.pi) * 16).astype(int)
    known = Known(t, phi, np.zeros(len(t), np.int64), bins, spot_and_sphere(wi)[:, None])
    boxes = cut(grid(1, 8, 16, sphere=True), np.pi / 32)
    found = integrate(
        boxes, lambda wi, cell: spot_and_sphere(wi)[None], (1, 256), 1e-6, budget, known=known if told else None
    )
    return found.total[0, 0], found.error[0, 0]


def test_a_lobe_between_the_nodes_is_missed_without_a_word_unless_directions_tell_of_it():
    blind, promised = spot_integral(500_000, told=False)
    assert (blind, promised) == (pytest.approx(0.5, abs=1e-9), pytest.approx(0.0, abs=1e-9))
    told, promised = spot_integral(500_000, told=True)
    assert told == pytest.approx(1.0, abs=1e-6)
    assert abs(told - 1) <= promised < 1e-3


def test_a_lobe_that_the_evaluations_do_not_reach_is_stated_as_error():
    short, promised = spot_integral(0, told=True)
    assert 0.1 < abs(short - 1) <= promised


def test_partition_gives_every_direction_one_leaf_and_follows_a_narrow_lobe():
    rng = np.random.default_rng(1)
    wi = rng.normal(size=(20_000, 3)) * 1e-3 + [0.3, -0.5, 0.8]
    wi /= np.linalg.norm(wi, axis=1, keepdims=True)
    tree = partition(*coordinates(wi), 8192, 8)
    assert tree.hits.sum() == 20_000 - 8192
    assert (tree.leaf >= 0).all()
    # Half a million bins of equal size would be needed to cut this lobe as finely.
    area = (tree.boxes[:, 1] - tree.boxes[:, 0]) * (tree.boxes[:, 3] - tree.boxes[:, 2])
    assert np.median(area) < 4 * math.pi / 5e5


def test_directions_and_coordinates_are_inverse_also_next_to_the_normal():
    t = np.array([1e-15, 1e-7, 0.3, 1.0, 1.7])
    phi = np.array([0.1, 1.0, 3.0, 4.0, 6.0])
    back = coordinates(directions(t, phi))
    assert np.allclose(back[0], t, rtol=1e-12)
    assert np.allclose(back[1], phi, rtol=1e-12)


@pytest.mark.parametrize("sharpness", [1, 100, 1e5])
def test_quadrature_resolves_lobes_of_any_width(sharpness):
    """A von Mises-Fisher lobe off the axis integrates to 1."""
    centre = np.array([0.6, 0.0, 0.8])

    def lobe(wi, cell):
        value = sharpness / (2 * np.pi * -np.expm1(-2 * sharpness)) * np.exp(sharpness * (wi @ centre - 1))
        return value[None]

    boxes = cut(grid(1, 8, 16, sphere=True), np.pi / 32)
    found = integrate(boxes, lobe, (1, 256), 1e-7, 3_000_000)
    assert found.total[0, 0] == pytest.approx(1, abs=1e-5)


def test_quadrature_keeps_bins_apart_and_knows_its_error():
    boxes = grid(2, 2, 2, sphere=False)
    step = integrate(
        boxes, lambda wi, cell: (np.where(wi[:, 2] > 0.3, 1.0, 0.0) * (1 + cell))[None], (2, 4), 1e-6, 2_000_000
    )
    assert step.by_bin[0, 0] == pytest.approx([math.pi / 2 * x for x in (1, 1, 0.4, 0.4)], abs=2e-3)
    assert step.total[0, 1] == pytest.approx(2 * step.total[0, 0], rel=1e-3)
    assert abs(step.total[0, 0] - 1.4 * math.pi) < max(3 * step.error[0, 0], 1e-9)


@pytest.mark.parametrize("alpha", [1, 1.5, 2, 3, 6])
def test_a_power_law_gives_its_index(alpha):
    levels = KEPT ** (np.arange(1, 25) / alpha)
    assert tail_index(levels) == pytest.approx(alpha, rel=1e-9)
    assert (tail_index(levels) < INFINITE_VARIANCE) == (alpha <= 2)
    assert tail_index(levels) < UNBOUNDED


def test_a_bounded_weight_has_no_index_even_with_a_high_narrow_peak():
    probability = KEPT ** -np.arange(1.0, 25)
    assert tail_index(np.full(24, 1.0)) == math.inf
    peak = 1 / (1e-3 + np.sqrt(probability))  # grows like a power law up to 1000, then stops
    assert tail_index(peak) > UNBOUNDED
    assert len(peak) > 2 * FITTED


def test_the_search_says_what_one_sample_in_4096_exceeds():
    """The weight 1/u1 exceeds W with the probability 1/W; a level scatters by a few percent, six of them by a tenth."""
    cells = Cells(np.zeros((8, 3)), np.zeros((8, 0)), np.zeros(8), np.zeros(8))
    effort = replace(FULL, tail_levels=8)
    reciprocal = SimpleNamespace(draw=lambda wo, u, *_: SimpleNamespace(weight=1 / np.maximum(u[:, 0], 1e-300)))
    tails = follow(reciprocal, cells, effort, np.random.default_rng(0))
    bounded = check_supremum(reciprocal, replace(tails, index=np.full(8, np.inf)))
    assert bounded.evidence["exceeded_once_in_4096"] == pytest.approx(4096, rel=0.5)
