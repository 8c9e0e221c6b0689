"""A user's own file, run as the command line runs it: in a process of its own, with limits."""

import json
import os
import shlex
import shutil
from pathlib import Path

import pytest

from tests.service import command_line
from tests.service.checks.conftest import BROKEN
from tests.service.checks.materialx_file import write as write_materialx

HEAD = '/*---\nprovides = ["technique"]\nname = "{name}"\ntitle = "Mine"\nsource = "own"\n---*/\n'
PDF = "float direction_pdf(vec3 wo, vec3 wi) { return INV_PI * max(wi.z, 0.0); }\n"
COSINE = "DirectionSample sample_direction(vec3 wo, vec2 u) {\n    return cosine_hemisphere(u);\n}\n"
ENDLESS = (
    "DirectionSample sample_direction(vec3 wo, vec2 u) { while (true) { u.x += 1.0; } return cosine_hemisphere(u); }\n"
)
INCLUDE = '#include "common/hemisphere.glsl"\n'
MARK = f"OWN_FILES_OF={os.getpid()}"


def samplerscope(*arguments):
    """Run the command line; its processes carry the mark."""
    return command_line.samplerscope(*arguments, env=dict([MARK.split("=")]))


@pytest.fixture
def own(tmp_path):
    def write(code, name="mine"):
        path = tmp_path / f"{name}.glsl"
        path.write_text(HEAD.format(name=name) + code)
        return path

    return write


def children_s():
    """Processor time of all processes that were started here and have ended."""
    times = os.times()
    return times.children_user + times.children_system


def workers():
    """Processes that are alive of those that `samplerscope` started here."""
    found = []
    for path in Path("/proc").glob("[0-9]*/environ"):
        try:
            variables = path.read_bytes()
        except OSError:
            continue
        if MARK.encode() in variables.split(b"\0"):
            found.append(path.parent)
    return found


def test_a_sound_file_passes_and_exits_with_0(own):
    done = samplerscope("check", own(INCLUDE + COSINE + PDF), "--quick", "--format", "json")
    result = json.loads(done.stdout)
    assert done.returncode == 0, done.stderr
    assert result["status"] == "pass"
    assert result["model"] == "eon"


def test_the_file_that_the_readme_shows_is_right_and_stands_beside_the_catalogue(tmp_path):
    text = (Path(__file__).parents[3] / "README.md").read_text()
    path = tmp_path / "my_cosine.glsl"
    path.write_text(text.partition("```glsl\n")[2].partition("```")[0])
    checked = samplerscope("check", path, "--quick")
    assert checked.returncode == 0, checked.stdout + checked.stderr
    options = ["--technique", f"{path},cosine,cltc-mis", "--angles", "4", "--samples", "1e4", "--format", "json"]
    series = json.loads(samplerscope("stats", *options).stdout)["series"]
    assert [one["technique"] for one in series] == ["my-cosine", "cosine", "cltc-mis"]


def test_a_broken_file_exits_with_1_and_writes_every_report(tmp_path):
    reports = [tmp_path / f"card{suffix}" for suffix in (".html", ".json", ".md")]
    options = [word for path in reports for word in ("--report", path)]
    done = samplerscope("check", BROKEN / "thin-tail.glsl", "--model", "lambert", "--quick", *options)
    assert done.returncode == 1
    assert "FAIL  tail" in done.stdout
    page, data, text = (path.read_text() for path in reports)
    assert page.count("<svg") >= 2
    assert "--u 0x" in page
    assert "src=" not in page  # nothing to load
    assert json.loads(data)["status"] == "fail"
    assert "| tail | **FAIL** |" in text
    assert "samplerscope check" in text


def test_compile_errors_have_the_files_own_lines(own):
    path = own(INCLUDE + COSINE + "float direction_pdf(vec3 wo, vec3 wi) {\n    return brightness;\n}\n")
    done = samplerscope("check", path, "--quick")
    assert done.returncode == 2
    assert f"{path}:12: 'brightness' : undeclared identifier" in done.stderr


@pytest.mark.parametrize(
    ("code", "says"),
    [
        (INCLUDE + ENDLESS + PDF, "65,535"),
        ("float table[268435456];\nDirectionSample sample_direction(vec3 wo, vec2 u) { table[int(u.x * 1e3)] = u.y;"
         " return DirectionSample(vec3(0, 0, 1), table[int(u.y * 1e8)]); }\n" + PDF, "memory"),
        ('#include "/etc/hostname"\n' + COSINE + PDF, ':7: #include "/etc/hostname"'),
        ('#include "../../etc/hostname"\n' + COSINE + PDF, "no such file to include"),
        ("shared float x[10];\n" + COSINE + PDF, ":7: shared"),
    ],
    ids=["endless loop", "1 GB array", "host file", "host file by relative path", "shared memory"],
)  # fmt: skip
def test_what_cannot_run_is_one_clear_error_within_60_seconds_and_leaves_nothing(own, tmp_path, code, says):
    path, begin, before = own(code), children_s(), set(tmp_path.iterdir())
    done = samplerscope("check", path, "--quick", "-o", tmp_path / "out.json")
    assert children_s() - begin < 60
    assert done.returncode == 2
    assert says in done.stderr
    assert "Traceback" not in done.stderr
    assert set(tmp_path.iterdir()) == before | {path}
    assert not workers()


def test_silence_ends_the_worker(own, monkeypatch):
    monkeypatch.setenv(*MARK.split("="))
    from service.isolation import Bounds, OwnFileFailed, run_isolated, tasks

    path = str(own(INCLUDE + COSINE + PDF))
    arguments = {
        "subject": path,
        "files": {path: Path(path).read_text()},
        "model": None,
        "techniques": None,
        "fixed": {},
        "device": None,
        "seed": 0,
        "quick": False,
    }
    assert "check" in tasks.TASKS
    with pytest.raises(OwnFileFailed, match=r"no answer for 0\.05 s"):
        run_isolated("check", arguments, bounds=Bounds(silence_s=0.05))
    assert not workers()


def test_statistics_take_a_file_and_never_the_reference_of_an_entry_of_the_same_name(own):
    """A file called like a technique of the catalogue, with another density: that one's truth must not judge it."""
    code = INCLUDE + "DirectionSample sample_direction(vec3 wo, vec2 u) { return uniform_hemisphere(u); }\n"
    path = own(code + "float direction_pdf(vec3 wo, vec3 wi) { return UNIFORM_DENSITY; }\n", "cosine")
    done = samplerscope("stats", "--model", path, "--samples", "20000", "--theta-o-deg", "0,60", "--format", "json")
    assert done.returncode == 0, done.stderr
    (series,) = json.loads(done.stdout)["series"]
    assert series["technique"] == "cosine"
    assert series["reference"]["mean"] == pytest.approx([1, 1], abs=1e-5)
    # The exact second moments of uniform sampling for EON at roughness 1; cosine has variances of 0.00494 and 0.215.
    assert series["reference"]["variance"] == pytest.approx([0.40359, 0.51146], abs=1e-4)
    assert series["mean"] == pytest.approx([1, 1], abs=0.03)
    assert "biased" not in {finding["name"] for finding in series["verdict"]["findings"]}


@pytest.fixture
def own_model(tmp_path):
    path = tmp_path / "grey.glsl"
    head = '/*---\nprovides = ["model"]\nname = "grey"\ntitle = "Grey"\nsource = "own"\n---*/\n'
    path.write_text(head + "float brdf(vec3 wi, vec3 wo) { return 0.5 * INV_PI; }\n")
    return path


def test_a_technique_file_stands_beside_those_of_the_catalogue_on_any_model(own):
    """Both draw by the cosine: their truths, of the file's own code and of the formulas, are one."""
    options = ["--model", "oren-nayar-full", "--theta-o-deg", "0,60", "--samples", "20000", "--format", "json"]
    done = samplerscope("stats", "--technique", f"{own(INCLUDE + COSINE + PDF)},cosine", *options)
    assert done.returncode == 0, done.stderr
    mine, cosine = json.loads(done.stdout)["series"]
    assert [mine["technique"], cosine["technique"]] == ["mine", "cosine"]
    assert mine["reference"]["variance"] == pytest.approx(cosine["reference"]["variance"], rel=1e-3)
    assert mine["verdict"]["status"] == cosine["verdict"]["status"]


def test_a_technique_file_runs_on_a_model_file(own, own_model):
    path = own(INCLUDE + COSINE + PDF)
    done = samplerscope("stats", "--model", own_model, "--technique", path, "--angles", "2", "--format", "json")
    (series,) = json.loads(done.stdout)["series"]
    assert (series["model"], series["technique"]) == ("grey", "mine")
    assert series["mean"] == pytest.approx([0.5, 0.5], abs=1e-6)


def test_a_failure_of_two_files_is_replayed_by_both_paths(own, own_model):
    path = own(INCLUDE + COSINE + "float direction_pdf(vec3 wo, vec3 wi) { return 0.5 * INV_PI * max(wi.z, 0.0); }\n")
    done = samplerscope("check", path, "--model", own_model, "--quick", "--format", "json")
    assert done.returncode == 1, done.stderr
    command = next(check for check in json.loads(done.stdout)["checks"] if check["status"] == "fail")["replay"][
        "command"
    ]
    again = samplerscope(*shlex.split(command)[1:])
    assert command.startswith(f"samplerscope check {path} --model {own_model} --technique mine")
    assert again.returncode == 0, again.stderr
    assert "mine on grey" in again.stdout


def test_a_value_beyond_float32_at_a_rounded_direction_is_no_fault(own):
    """Below the horizon in float64, next to it in float32, where the truth of Ward's model has no float32."""
    rounded = "return DirectionSample(vec3(-wo.xy, DROP), wo.z < 1e-30 ? 1.0 : 0.0);"
    drop = "#ifdef DOUBLE_PRECISION\n#define DROP -1e-9\n#else\n#define DROP 1e-36\n#endif\n"
    path = own(drop + f"DirectionSample sample_direction(vec3 wo, vec2 u) {{ {rounded} }}\n" + PDF)
    done = samplerscope("check", path, "--model", "ward", "--quick", "--format", "json")
    (finite,) = (check for check in json.loads(done.stdout)["checks"] if check["name"] == "finite")
    assert finite["status"] == "pass", finite["message"]
    assert finite["evidence"]["beyond_float32"] > 0


REJECTION = """uint state;
float next() { state = state * 747796405u + 2891336453u; return float(state >> 8) * 5.9604644775390625e-8; }
DirectionSample sample_direction(vec3 wo, vec2 u) {
    state = uint(u.x * 4294967040.0) ^ uint(u.y * 16777216.0);
    vec3 d;
    for (int i = 0; i < 100; i++) {
        d = vec3(2.0 * next() - 1.0, 2.0 * next() - 1.0, next());
        if (dot(d, d) <= 1.0) break;
    }
    return DirectionSample(normalize(d), DENSITY * INV_PI);
}
float direction_pdf(vec3 wo, vec3 wi) { return wi.z > 0.0 ? DENSITY * INV_PI : 0.0; }
"""


@pytest.mark.parametrize(
    ("density", "fails"), [("0.5", set()), ("0.4", {"pdf-normalisation", "chi-square", "unbiased"})]
)
def test_rejection_sampling_has_no_jacobian_and_is_judged_by_the_other_checks(own, density, fails):
    path = own(f"#define DENSITY {density}\n{REJECTION}")
    done = samplerscope("check", path, "--model", "lambert", "--quick", "--format", "json")
    checks = {check["name"]: check["status"] for check in json.loads(done.stdout)["checks"]}
    assert {name for name, status in checks.items() if status == "fail"} == fails
    assert checks["jacobian"] == "not-applicable"


def test_two_files_of_one_name_are_refused(own):
    first = own(INCLUDE + COSINE + PDF)
    (first.parent / "other").mkdir()
    second = Path(shutil.copy(first, first.parent / "other"))
    done = samplerscope("stats", "--technique", f"{first},{second}", "--angles", "2")
    assert done.returncode == 2
    assert f"{second}: head: name = mine: so is the technique of {first} called" in done.stderr


def test_a_file_may_be_called_anything(own):
    path = own(INCLUDE + COSINE + PDF + "float x = y;\n")
    path = path.rename(path.with_name('a "strange"\n näme.glsl'))
    done = samplerscope("check", path, "--quick")
    assert done.returncode == 2
    assert "a _strange__ näme.glsl:12: 'y' : undeclared identifier" in done.stderr


@pytest.mark.parametrize("command", [["check"], ["stats", "--model"]])
def test_a_technique_file_is_never_passed_over_in_silence(own, command):
    done = samplerscope(*command, own(INCLUDE + COSINE + PDF), "--technique", "cosine")
    assert done.returncode == 2
    assert done.stdout == ""
    assert "techniques = cosine: allowed is" in done.stderr
    assert "mine" in done.stderr


def test_a_loop_in_statistics_that_reaches_the_limit_is_an_error(own):
    loop = "float x = 0.0; for (int i = 0; i < 400; i++) x += u.x;"
    code = (
        f"DirectionSample sample_direction(vec3 wo, vec2 u) "
        f"{{ {loop} return cosine_hemisphere(vec2(u.x, fract(x))); }}\n"
    )
    done = samplerscope("stats", "--model", own(INCLUDE + code + PDF), "--samples", "20000", "--angles", "2")
    assert done.returncode == 2
    assert "loop" in done.stderr


def test_stability_takes_a_file(own):
    fragile = "float direction_pdf(vec3 wo, vec3 wi) { return INV_PI * max(wi.z, 0.0) * (wo.z / wo.z); }\n"
    done = samplerscope("stability", "--model", own(INCLUDE + COSINE + fragile), "--format", "json")
    result = json.loads(done.stdout)
    assert done.returncode == 1
    assert result["status"] == "fail"
    assert result["checks"][0]["evidence"]["nonfinite"] > 0
    assert "--wo" in result["checks"][0]["replay"]["command"]


def test_functions_that_materialx_ships_are_checked_and_their_energy_gain_is_found(tmp_path):
    """The energy-compensated lobe is called with dot(L, V) clamped at 0, as in the package's BSDF: it gains 16 %."""
    path = write_materialx(tmp_path, "materialx-compensated")
    done = samplerscope("check", path, "--technique", "cosine", "--quick", "--format", "json")
    result = json.loads(done.stdout)
    failed = [check for check in result["checks"] if check["status"] == "fail"]
    assert done.returncode == 1, done.stderr
    assert [check["name"] for check in failed] == ["energy"]
    assert 1.1 < failed[0]["evidence"]["largest_albedo"] < 1.2
    assert failed[0]["replay"]["command"].startswith("samplerscope check ")
    statistics = samplerscope("stats", "--model", path, "--samples", "20000", "--theta-o-deg", "80", "--format", "json")
    means = [series["mean"][0] for series in json.loads(statistics.stdout)["series"]]
    assert len(means) == 2
    assert means == pytest.approx([1.12, 1.12], abs=0.04)


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        (["nothing"], "subject = nothing"),
        (["nothing.glsl"], "can be read"),
        (["cosine", "--model", "phong"], "model = phong"),
        (["cosine", "--set", "roughness=x"], "set = roughness=x"),
        (["cosine", "--set", "gloss=1"], "parameters.gloss"),
        (["cosine", "--set", "roughness=7"], "parameters.roughness = 7.0: allowed is 0 to 1"),
        (["cosine", "--set", "roughness=1", "--set", "roughness=0"], "roughness=0: allowed is roughness once"),
        (["cosine", "--seed", "-1"], "seed = -1"),
        (["cosine", "--report", "card.pdf"], ".html"),
        (["cosine", "--u", "0,0"], "wo"),
        (["cosine", "--wo", "0,0,1"], "--u or --wi"),
        (["cosine", "--wo", "0,0", "--u", "0,0"], "wo = 0,0"),
    ],
)
def test_bad_input_is_one_line_and_exit_code_2(arguments, says):
    done = samplerscope("check", *arguments)
    assert done.returncode == 2
    assert says in done.stderr
    assert len(done.stderr.strip().splitlines()) == 1
