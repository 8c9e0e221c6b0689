"""Slopes, targets and intervals on errors whose law is known; no device."""

import numpy as np
import pytest
from scipy.stats import t

from service.convergence.fit import fit_power_law, student_quantile
from service.convergence.ranking import Contender, product_interval, rank

COUNTS = [2**k for k in range(4, 15)]
ONE = np.ones(1)


def running_means(rng, replicates=32):
    """Errors of nested means of unit normals, (counts, replicates, 1)."""
    sums = np.cumsum(rng.normal(size=(COUNTS[-1], replicates)), axis=0)
    return np.array([sums[count - 1] / count for count in COUNTS])[..., None]


def test_intervals_of_slope_and_target_hold_the_truth_at_their_rate():
    """95 % intervals; over 200 seeds the binomial bounds at 1e-3 each side are 89.5 % and 98.7 %."""
    slopes, counts = [], []
    for seed in range(200):
        errors = 0.3 * running_means(np.random.default_rng(seed))
        fit = fit_power_law(COUNTS, errors, 0 * ONE, ONE, 0.01, curves=1, independent=True)
        slopes.append(fit.slope_interval[0, 0] <= -0.5 <= fit.slope_interval[0, 1])
        counts.append(fit.count_interval[0, 0] <= 900 <= fit.count_interval[0, 1])
    assert 0.895 <= np.mean(slopes) <= 0.987
    assert 0.895 <= np.mean(counts) <= 0.987


def test_a_steeper_law_is_fitted_and_extrapolated():
    rng = np.random.default_rng(3)
    errors = np.array([rng.normal(size=32) * 2.0 / count for count in COUNTS])[..., None]
    fit = fit_power_law(COUNTS, errors, 0 * ONE, ONE, 1e-3, curves=1, independent=False)
    assert fit.slope_interval[0, 0] < -1 < fit.slope_interval[0, 1] < -0.8
    assert fit.count_interval[0, 0] < 2000 < fit.count_interval[0, 1]


def test_the_bias_is_taken_off_before_the_fit_and_bounds_the_target():
    """With intervals for one curve of a thousand: 99.995 %."""
    errors = 0.3 * running_means(np.random.default_rng(1)) + 0.008
    within = fit_power_law(COUNTS, errors, 0.008 * ONE, ONE, 0.01, curves=1000, independent=True)
    assert within.slope_interval[0, 0] < -0.5 < within.slope_interval[0, 1]
    assert within.count_interval[0, 0] < 0.09 / (0.01**2 - 0.008**2) < within.count_interval[0, 1]
    beyond = fit_power_law(COUNTS, errors, 0.008 * ONE, ONE, 0.005, curves=1000, independent=True)
    assert np.isinf(beyond.count_to_target[0])


def test_nothing_is_fitted_where_the_tail_is_not_seen():
    errors = running_means(np.random.default_rng(2))
    fit = fit_power_law(COUNTS, errors, 0 * ONE, np.array([np.inf]), 0.01, curves=1, independent=True)
    assert np.isnan(fit.slope[0])
    assert np.isnan(fit.count_to_target[0])


@pytest.mark.parametrize(("confidence", "freedom"), [(0.95, 31), (0.99, 31), (0.999, 31), (0.95, 1023)])
def test_student_quantiles_are_those_of_scipy(confidence, freedom):
    assert np.isclose(student_quantile(confidence, freedom), t.ppf(0.5 + confidence / 2, freedom), rtol=1e-4)


def test_a_ranking_tells_apart_only_what_is_apart():
    ranked = rank(
        [
            Contender("slow", 9.0, (8.0, 10.0)),
            Contender("fast", 1.0, (0.9, 1.1)),
            Contender("close", 1.1, (1.0, 1.2)),
            Contender("biased", None, None),
        ]
    )
    assert ranked["order"] == ["fast", "close", "slow"]
    assert ranked["tied"] == [["fast", "close"]]
    assert not ranked["distinguishable"]
    assert ranked["unranked"] == ["biased"]
    assert ranked["lead"] == pytest.approx(1.1)


def test_intervals_apart_by_less_than_runs_differ_are_tied():
    assert rank([Contender("a", 1.0, (0.99, 1.01)), Contender("b", 1.05, (1.04, 1.06))])["tied"] == [["a", "b"]]
    assert rank([Contender("a", 1.0, (0.99, 1.01)), Contender("b", 1.2, (1.19, 1.21))])["distinguishable"]


def test_the_interval_of_a_product_is_as_wide_as_both_together():
    low, high = product_interval((0.5, 2.0), (1.0, 1.0))
    assert (low, high) == pytest.approx((0.5, 2.0))
    low, high = product_interval((0.5, 2.0), (0.5, 2.0))
    assert high == pytest.approx(2.0 ** np.sqrt(2))
    assert low == pytest.approx(1 / high)
