"""Whether 95 % intervals hold the reference in 95 % of cases. `make bench` does the same at a million samples."""

import numpy as np

NORMAL_95 = 1.959964
SEEDS = 40
ROUGHNESS = [0.5, 1.0]
TECHNIQUES = ["uniform", "cltc-mis"]
ANGLES = [0.0, 30.0, 60.0, 80.0, 89.0]


def test_intervals_of_mean_and_variance_hold_the_reference(compute):
    """Kurtosis is below 40 in these cells, so that 40,000 samples are enough for error bars of the variance.

    Cells of one seed and angle share random numbers. Even if those 4 were one, 200 independent cases would be left:
    the binomial bounds at 1e-3 on either side of 95 % are then 89.5 % and 98.7 %.
    """
    held = {"mean": [], "variance": []}
    for seed in range(SEEDS):
        result = compute(
            techniques=TECHNIQUES,
            parameters={"roughness": ROUGHNESS},
            theta_o_deg=ANGLES,
            statistics=["mean", "variance"],
            estimator={"samples": 40_000, "seed": 500 + seed},
        )
        for series in result["series"]:
            for name, cells in held.items():
                off = np.abs(np.array(series[name]) - series["reference"][name])
                cells.append(off <= NORMAL_95 * np.array(series[f"{name}_stderr"]))
    for cells in held.values():
        assert 0.895 < np.mean(cells) < 0.987
