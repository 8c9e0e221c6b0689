"""The host's random numbers: keyed by value, uniform, and fine-grained near 0."""

import numpy as np

from service.random_numbers import cell_key, random_pairs


def test_a_key_depends_on_seed_and_angle_alone():
    assert cell_key(3, 45.0) == cell_key(3, 45.0, 0.0)
    keys = {cell_key(seed, angle, phi) for seed in range(20) for angle in (0.0, 1e-9, 45.0) for phi in (0.0, 30.0)}
    assert len(keys) == 20 * 3 * 2
    assert cell_key(0, -0.0) == cell_key(0, 0.0)


def test_pairs_are_uniform_and_independent():
    """A million pairs in 64 x 64 bins: chi-square with 4095 degrees of freedom, mean 4095, standard deviation 90.5.
    The bound of 5 standard deviations is passed by chance once in 1.7 million; the seed is fixed."""
    u = random_pairs(cell_key(0, 10.0), np.arange(1_000_000, dtype=np.uint64))
    counts, *_ = np.histogram2d(u[:, 0], u[:, 1], bins=64, range=[[0, 1], [0, 1]])
    chi_square = np.sum((counts - counts.mean()) ** 2) / counts.mean()
    assert abs(chi_square - 4095) < 5 * np.sqrt(2 * 4095)


def test_successive_samples_and_neighbouring_views_are_uncorrelated():
    """Correlations of 2^18 numbers have a standard deviation of 1/512; 5 of them are the bound."""
    first = random_pairs(cell_key(0, 10.0), np.arange(2**18, dtype=np.uint64)).astype(np.float64) - 0.5
    other = random_pairs(cell_key(0, 10.000001), np.arange(2**18, dtype=np.uint64)).astype(np.float64) - 0.5
    bound = 5 / 512
    for a, b in [(first[:-1, 0], first[1:, 0]), (first[:, 0], first[:, 1]), (first[:, 0], other[:, 0])]:
        assert abs(np.mean(a * b) * 12) < bound


def test_numbers_stay_in_the_half_open_square_and_reach_below_24_bits():
    u = random_pairs(cell_key(7, 0.0), np.arange(2**22, dtype=np.uint64))
    assert u.min() >= 0
    assert u.max() < 1
    smallest = np.sort(u[:, 0])[:64].astype(np.float64)
    assert np.any(np.mod(smallest * 2**24, 1) != 0)
