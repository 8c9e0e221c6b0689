"""The scrambled Sobol' sequence against SciPy's, and its estimates against the reference."""

import numpy as np
import pytest
from scipy.stats import qmc

from service.random_numbers import _pascal, _reversed_bits, replicate_key, scrambled_sobol_pairs


def test_the_unscrambled_sequence_is_that_of_scipy():
    """Joe and Kuo's first two dimensions are the radical inverse and the Pascal matrix."""
    index = np.arange(1 << 12, dtype=np.uint32)
    mine = np.stack([_reversed_bits(index), _reversed_bits(_pascal(index))], axis=1) * 2.0**-32
    theirs = qmc.Sobol(2, scramble=False).random(1 << 12)
    # SciPy runs through each block of 2^k points in Gray-code order: the same points in another order.
    for size in (1, 2, 16, 1 << 12):
        assert {tuple(row) for row in mine[:size]} == {tuple(row) for row in theirs[:size]}


@pytest.mark.parametrize("key", [(1, 2), (0xDEADBEEF, 0x12345678), (0, 0)])
def test_every_elementary_interval_holds_one_point_of_a_net(key):
    """Owen scrambling keeps a (0, m, 2)-net one: each 2^-a x 2^-(m - a) box has exactly one of 2^m points."""
    m = 10
    points = scrambled_sobol_pairs(key, np.arange(1 << m, dtype=np.uint64)).astype(float)
    for a in range(m + 1):
        boxes = np.floor(points * [2**a, 2 ** (m - a)]).astype(int)
        assert len({tuple(box) for box in boxes}) == 1 << m


def test_scrambled_points_are_uniform_over_keys():
    """One point over 4096 keys: chi-square of 64 bins with 63 degrees of freedom, below its 1 - 1e-4 quantile 113."""
    rng = np.random.default_rng(7)
    keys = rng.integers(0, 2**32, (4096, 2), dtype=np.uint64).tolist()
    for index in (0, 5, 70_000):
        points = np.array([scrambled_sobol_pairs(tuple(key), np.array([index], np.uint64))[0] for key in keys])
        for u in points.T:
            counts = np.bincount((u * 64).astype(int), minlength=64)
            assert np.sum((counts - 64) ** 2 / 64) < 113


def test_the_device_draws_the_same_points(compute):
    """Through statistics that depend on every bit: the mean weight of `uniform` on Lambert is the mean of 2 u1."""
    (series,) = compute(
        model="lambert",
        techniques="uniform",
        theta_o_deg=[33],
        estimator={"method": "qmc", "samples": 1 << 12, "seed": 4},
    )["series"]
    u1 = [scrambled_sobol_pairs(replicate_key(4, r, 33.0), np.arange(256, dtype=np.uint64))[:, 0] for r in range(16)]
    assert series["samples"] == 1 << 12
    assert np.isclose(series["mean"][0], 2 * np.mean(np.array(u1, float)), rtol=1e-7)
    assert np.isclose(series["max_weight"][0], 2 * np.max(u1), rtol=1e-6)


def test_qmc_is_closer_than_mc_at_the_same_count(compute):
    def worst(method):
        (series,) = compute(
            techniques="uniform", theta_o_deg=[0, 30, 60], estimator={"method": method, "samples": 1 << 16, "seed": 2}
        )["series"]
        return np.max(np.abs(np.array(series["reference"]["mean_error"], float)))

    assert worst("qmc") < 0.05 * worst("mc")


def test_qmc_error_bars_hold_the_reference(compute):
    """Student's t of 15 degrees of freedom: 95 % within 2.13. 4 x 10 x 12 cells, of which the binomial bound at 1e-3
    allows between 90.5 % and 98.5 %; qmc means are correlated between angles of one seed no more than mc ones."""
    held = []
    for seed in range(12):
        result = compute(
            techniques=["cosine", "uniform", "ltc-nonnegative", "cltc-mis"],
            theta_o_deg={"count": 10},
            estimator={"method": "qmc", "samples": 1 << 12, "seed": seed},
            statistics=["mean", "variance"],
        )
        for series in result["series"]:
            angles = np.array(series["theta_o_deg"]) <= 80
            off = np.abs(np.array(series["mean"]) - series["reference"]["mean"])
            held += list((off <= 2.131 * np.array(series["mean_stderr"]) + 2e-7)[angles])
    assert 0.905 < np.mean(held) < 0.985
