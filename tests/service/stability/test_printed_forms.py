"""What the reformulation gained: formulas as printed fail on the edge grid, the forms of the catalogue do not."""

from pathlib import Path

import pytest

from service.catalogue import load_catalogue
from service.engine import Engine
from service.scene import parse_scene, resolve
from service.stability import compute_stability

PRINTED = Path(__file__).parents[2] / "printed"


def evidence(engine, model, technique, file=None):
    catalogue = load_catalogue() if file is None else load_catalogue().with_file(PRINTED / f"{file}.glsl")
    scene = parse_scene({"model": model, "techniques": [technique]})
    result = compute_stability(resolve(scene, catalogue), Engine(engine.device, catalogue, engine.cache))
    lost = sum(e["points"] for e in result["exceptions"] if e["reason"].startswith("digits lost"))
    return result["checks"][0]["evidence"], lost


@pytest.mark.parametrize(
    ("printed", "stable"),
    [
        (("printed-eon", "cosine", "printed-eon"), ("eon", "cosine")),
        (("eon", "printed-cltc", "printed-cltc"), ("eon", "cltc")),
    ],
    ids=["eon", "cltc"],
)
def test_the_stable_forms_are_finite_and_keep_their_digits_where_the_printed_do_not(engine, printed, stable):
    before, lost_before = evidence(engine, *printed)
    after, lost_after = evidence(engine, *stable)
    assert before["points"] == after["points"]
    assert before["nonfinite"] > 0
    assert lost_before > 0
    assert (after["nonfinite"], after["wrong"], lost_after) == (0, 0, 0)


def test_the_printed_clipped_lobe_is_unstable_too(engine):
    assert evidence(engine, "eon", "printed-cltc", "printed-cltc")[0]["wrong"] > 1000
