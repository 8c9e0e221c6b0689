"""Every planted bug is caught, the right property is named, and its replay shows it again."""

import shlex

import numpy as np
import pytest

from service.catalogue import load_catalogue
from service.checks.replaying import parse_floats, replay_inputs
from service.checks.selection import select
from service.engine import Engine
from tests.service.checks.conftest import BROKEN, failures, outcome

# What must fail, and what else may: one bug often breaks several laws at once.
MODELS = {
    "energy": ({"energy"}, set()),
    "negative": ({"nonnegative"}, set()),
    "not-reciprocal": ({"reciprocity"}, set()),
    "wrong-albedo": ({"energy"}, set()),
}
TECHNIQUES = {
    "pdf-factor": ({"pdf-normalisation", "unbiased"}, {"chi-square", "jacobian"}),
    "no-jacobian": ({"jacobian"}, {"finite", "nonnegative", "pdf-normalisation", "chi-square", "unbiased", "coverage"}),
    "lobe-probability": ({"chi-square", "unbiased"}, set()),
    "missing-part": ({"coverage"}, {"unbiased"}),
    "swapped-directions": ({"pdf-agreement"}, {"pdf-normalisation", "chi-square"}),
    "nan-at-grazing": ({"finite"}, set()),
    "nan-at-zero": ({"finite"}, set()),
    "not-uniform": ({"chi-square", "jacobian"}, {"unbiased"}),
    "density-zero": ({"pdf-agreement", "coverage"}, {"pdf-normalisation", "chi-square", "unbiased"}),
    "below-horizon": ({"hemisphere"}, set()),
    "wrong-handedness": ({"chi-square", "pdf-agreement"}, set()),
    "thin-tail": ({"tail", "supremum"}, set()),
    "not-normalised": ({"unit-length"}, set()),
    "negative-density": (
        {"nonnegative"},
        {"pdf-normalisation", "chi-square", "jacobian", "coverage", "unbiased", "tail", "supremum"},
    ),
    "seam": ({"continuity"}, set()),
    "sharp-lobe": ({"chi-square", "jacobian"}, {"coverage", "unbiased", "tail", "supremum"}),
}
BUGS = {**MODELS, **TECHNIQUES}


def run(battery, name):
    if name in MODELS:
        return battery(BROKEN / f"{name}.glsl", techniques=["cosine"])
    return battery(BROKEN / f"{name}.glsl", "lambert")


def test_every_planted_bug_is_tested():
    assert {path.stem for path in BROKEN.glob("*.glsl")} == set(BUGS)
    assert len(BUGS) >= 14


@pytest.mark.parametrize("name", BUGS)
def test_a_planted_bug_is_caught_and_named(battery, name):
    required, allowed = BUGS[name]
    found = failures(run(battery, name))
    assert required <= found
    assert found <= required | allowed


@pytest.mark.parametrize("name", BUGS)
def test_every_failure_carries_its_inputs_and_a_command(battery, name):
    for check in run(battery, name)["checks"]:
        if check["status"] == "fail":
            replay = check["replay"]
            assert {"model", "technique", "parameters", "theta_o_deg", "wo_bits", "command"} <= set(replay)
            assert len(replay.get("u_bits", replay.get("wi_bits"))) in (2, 3)
        else:
            assert check["replay"] is None


def replayed(engine, command):
    words = shlex.split(command)
    assert words[:2] == ["samplerscope", "check"]
    options = dict(zip(words[3::2], words[4::2], strict=True)) | {"--set": words}
    fixed = dict(word.split("=") for word in words if "=" in word)
    fixed = {name: float(value) for name, value in fixed.items()}
    subject = select(words[2], load_catalogue(), options["--model"], [options["--technique"]], fixed)
    at = Engine(engine.device, subject.catalogue, engine.cache)
    u = parse_floats("u", options["--u"], 2) if "--u" in options else None
    wi = parse_floats("wi", options["--wi"], 3) if "--wi" in options else None
    return replay_inputs(at, subject, parse_floats("wo", options["--wo"], 3), u, wi)


@pytest.mark.parametrize(
    ("name", "check", "shows"),
    [
        ("nan-at-grazing", "finite", lambda r: "pdf" in r["float32"]["nonfinite"]),
        ("nan-at-zero", "finite", lambda r: "wi" in r["float32"]["nonfinite"]),
        ("negative", "nonnegative", lambda r: r["float32"]["brdf"] < 0),
        ("below-horizon", "hemisphere", lambda r: r["float32"]["wi"][2] < 0 < r["float32"]["pdf"]),
        ("not-normalised", "unit-length", lambda r: abs(np.linalg.norm(r["float32"]["wi"]) - 1) > 1e-5),
        ("density-zero", "pdf-agreement", lambda r: r["float32"]["direction_pdf"] == 0 < r["float32"]["pdf"]),
        ("missing-part", "coverage", lambda r: r["float32"]["direction_pdf"] == 0 < r["float32"]["brdf"]),
        ("thin-tail", "supremum", lambda r: r["float32"]["weight"] > 1e4),
        (
            "swapped-directions",
            "pdf-agreement",
            lambda r: abs(r["float64"]["pdf"] / r["float64"]["direction_pdf"] - 1) > 1e-3,
        ),
    ],
)
def test_the_replay_shows_the_failure(battery, engine, name, check, shows):
    command = outcome(run(battery, name), check)["replay"]["command"]
    assert shows(replayed(engine, command))
