"""What leaving things out saves: variants beside the shaders that keep everything.

Run it by itself with `python -m tests.benchmarks.variants`.

The scenes have between them every kind of feature that can be left out. Of the first a factor is promised.
"""

from __future__ import annotations

from typing import Any

from service.engine import Engine
from service.explain import compute_explanation, parse_explain_scene
from service.formats.kinds.explain import text
from service.scene import resolve

PROMISED = 1.5
SMOOTH = {"model": "eon", "parameters": {"roughness": 0}, "techniques": ["cosine"], "statistics": ["mean"]}
SCENES: tuple[dict[str, Any], ...] = (
    SMOOTH,
    {"model": "eon", "parameters": {"roughness": 0}, "techniques": ["cltc-mis", "ltc"]},
    {"model": "eon", "parameters": {"roughness": 0.5, "albedo": 0.8}},
    {"model": "fon", "parameters": {"roughness": 0, "albedo": 0.5}, "techniques": ["uniform"]},
    {"model": "qon", "parameters": {"sigma": 0}, "techniques": ["cosine"], "statistics": ["max_weight"]},
    {"model": "kurt", "parameters": {"alpha": 0, "lobe_probability": 0}, "techniques": ["half-vector-cosine"]},
    {"model": "kurt-coupled", "parameters": {"ks": 0, "lobe_probability": 1}, "techniques": ["half-vector-cosine"]},
    {"model": "kurt-multilobe", "parameters": {"ks2": 0}, "techniques": ["kurt-multilobe"]},
    {"model": "eon", "parameters": {"albedo": 0}, "techniques": ["cosine"]},
)


def variants(engine: Engine) -> dict[str, Any]:
    """The explanations of all scenes, printed; whether the promise of the first holds."""
    found = []
    for scene in SCENES:
        found.append(compute_explanation(resolve(parse_explain_scene(scene), engine.catalogue), engine))
        print(text(found[-1]))
    factor = found[0]["shaders"][0]["speedup"]["median"]
    kept = "as promised" if factor >= PROMISED else f"BELOW the {PROMISED} that is promised"
    print(f"roughness 0, cosine, mean: {factor:.2f} times as fast as the full shader, {kept}\n")
    return {"explanations": found, "factor": factor, "promised": PROMISED}


if __name__ == "__main__":
    with Engine.open() as opened:
        variants(opened)
