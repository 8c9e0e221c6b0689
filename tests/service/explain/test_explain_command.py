"""`samplerscope explain` as a user meets it."""

import json

from tests.service.command_line import samplerscope

OWN = """/*---
provides = ["model"]
name = "mine"
title = "Mine"
source = "own"
---*/
float brdf(vec3 wi, vec3 wo) { return min(wi.z, wo.z) > 0.0 ? INV_PI : 0.0; }
"""


def test_the_table_says_what_is_left_out_and_why():
    done = samplerscope(
        "explain", "--model", "lambert", "--technique", "cosine", "--theta-o-deg", "0,60", "--statistics", "mean"
    )
    assert done.returncode == 0, done.stderr
    for words in ("lambert with cosine", "largest weight", "max_weight was not asked for", "times as fast"):
        assert words in done.stdout


def test_a_users_own_file_is_explained_in_a_process_of_its_own(tmp_path):
    path = tmp_path / "mine.glsl"
    path.write_text(OWN)
    done = samplerscope("explain", "--model", path, "--technique", "cosine", "--theta-o-deg", "30", "--format", "json")
    assert done.returncode == 0, done.stderr
    result = json.loads(done.stdout)
    assert len(result["left_out"]) == 2  # what its head says of itself is not believed; these two need no belief
    assert result["shaders"][0]["model"] == "mine"


def test_an_estimator_without_samples_gets_one_line_and_exit_code_2():
    done = samplerscope("explain", "--method", "quadrature")
    assert done.returncode == 2
    assert "estimator.method" in done.stderr
    assert done.stderr.count("\n") == 1
