"""The command line as a user meets it: in a process of its own, on the real driver."""

import contextlib
import json
import os
import subprocess
import sys

import pytest

from tests.service.command_line import ROOT, samplerscope

SMALL = ["stats", "--technique", "cosine,cltc-mis", "--theta-o-deg", "0,80", "--samples", "20000", "--seed", "3"]


def result_of(*arguments, env=None):
    done = samplerscope(*arguments, "--format", "json", env=env)
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout)


def numbers(result):
    return [{k: v for k, v in series.items() if k != "device_ms"} for series in result["series"]]


def test_the_table_goes_to_stdout_and_progress_to_stderr():
    done = samplerscope(*SMALL)
    assert done.returncode == 0
    assert "variance" in done.stdout
    assert "cltc-mis" in done.stdout
    assert "%" in done.stderr
    assert "\x1b" not in done.stdout


def test_one_and_two_driver_threads_give_the_same_bits():
    one, two = (numbers(result_of(*SMALL, env={"LP_NUM_THREADS": count})) for count in ("1", "2"))
    assert one == two == numbers(result_of(*SMALL))


@pytest.mark.parametrize("bits", ["128", "256"])
def test_vectors_of_any_width_give_the_same_bits(bits):
    """The driver's cache would answer with the code of another width."""
    width = {"LP_NATIVE_VECTOR_WIDTH": bits, "MESA_SHADER_CACHE_DISABLE": "true"}
    result = result_of(*SMALL, env=width)
    assert f"{bits} bits" in result["run"]["device"]
    assert numbers(result) == numbers(result_of(*SMALL))


def test_another_seed_gives_other_samples_of_the_same_law():
    first, other = (result_of(*SMALL[:-1], seed)["series"][1] for seed in ("3", "4"))
    assert first["mean"] != other["mean"]
    for a, b, s in zip(first["mean"], other["mean"], first["mean_stderr"], strict=True):
        assert abs(a - b) < 6 * 2**0.5 * s


@pytest.mark.parametrize(
    ("arguments", "names"),
    [
        (["--set", "roughness=1.5"], ["roughness", "1.5", "0 to 1"]),
        (["--set", "roughness=nan"], ["roughness", "nan", "0 to 1"]),
        (["--set", "roughness"], ["roughness", "NAME=VALUE"]),
        (["--set", "rough=1"], ["rough", "roughness"]),
        (["--technique", "cosin"], ["cosin", "cosine", "cltc-mis"]),
        (["--model", "enon"], ["enon", "eon"]),
        (["--theta-o-deg", "90"], ["theta_o_deg", "90", "< 90"]),
        (["--theta-o-deg", "12,120"], ["theta_o_deg", "120", "< 90"]),
        (["--angles", "0"], ["theta_o_deg.count", "0", "1 to"]),
        (["--angles", "many"], ["angles", "many", "whole number"]),
        (["--samples", "0"], ["samples", "0", "1 to"]),
        (["--samples", "-5"], ["samples", "-5", "1 to"]),
        (["--samples", "1.5"], ["samples", "1.5", "whole number"]),
        (["--samples", "inf"], ["samples", "inf", "whole number"]),
        (["--set", "roughness=1", "--set", "roughness=0.5"], ["roughness=0.5", "once"]),
        (["--model", "eon", "--preset", "red-velvet"], ["model", "eon", "--preset red-velvet"]),
        (["--model", "no-such.file"], ["no-such.file", "can be read"]),
        (["--method", "magic"], ["method", "magic", "mc"]),
        (["--statistics", "median"], ["statistics", "median", "variance"]),
        (["--format", "xml"], ["format", "xml", "json"]),
        (["-o", "result.xyz"], ["result.xyz", ".json"]),
        (["-o", "/proc/no/such/place.json"], ["output", "/proc/no/such/place.json"]),
        (["--no-such-option"], ["--no-such-option"]),
        (["--angles", "3", "--theta-o-deg", "4"], ["angles", "theta-o-deg"]),
    ],
)
def test_bad_input_gets_one_line_and_exit_code_2(arguments, names, tmp_path):
    done = samplerscope("stats", *arguments)
    assert done.returncode == 2
    assert done.stdout == ""
    assert len(done.stderr.strip().splitlines()) == 1
    assert all(name in done.stderr for name in names)


def test_an_unwritable_output_is_found_before_anything_is_computed(tmp_path):
    (tmp_path / "folder.json").mkdir()
    done = samplerscope("stats", "--samples", "1000000000000", "-o", str(tmp_path / "folder.json"))
    assert done.returncode == 2
    assert "folder" in done.stderr
    assert list((tmp_path / "folder.json").iterdir()) == []


@pytest.mark.parametrize("option", [["--format", "png"], ["-o", "card.svg"]])
def test_a_format_that_a_command_has_not_is_found_before_anything_is_computed(option, tmp_path):
    done = samplerscope("stability", *option)
    assert done.returncode == 2
    assert done.stdout == ""
    (line,) = done.stderr.strip().splitlines()
    assert "json" in line


def on_a_terminal(*arguments, columns):
    """The exit code, and what a pseudo-terminal with so many columns shows of stdout."""
    command = [sys.executable, "-c", "from service.cli import main; main()", *arguments]
    here, there = os.openpty()
    done = subprocess.Popen(
        command, stdout=there, stderr=subprocess.DEVNULL, env={**os.environ, "COLUMNS": str(columns)}
    )
    os.close(there)
    shown = b""
    with contextlib.suppress(OSError):  # the end of a pseudo-terminal
        while part := os.read(here, 1 << 16):
            shown += part
    os.close(here)
    return done.wait(60), shown.decode().replace("\r\n", "\n")


@pytest.mark.parametrize(("columns", "least", "most"), [(80, 0, 80), (200, 81, 120)])
def test_a_table_fits_the_terminal(columns, least, most):
    """The table of a file or a pipe has lines of over 80 columns."""
    code, shown = on_a_terminal(*SMALL, columns=columns)
    assert code == 0
    assert "variance" in shown
    assert least <= max(map(len, shown.splitlines())) <= most


def test_a_picture_is_not_printed_on_a_terminal():
    assert on_a_terminal(*SMALL, "--format", "png", columns=80) == (2, "")


@pytest.mark.parametrize("name", ["-", "/dev/stdout"])
def test_a_dash_is_standard_output_which_keeps_what_others_wrote_there(name, tmp_path):
    out = tmp_path / "out.csv"
    with out.open("w") as stream:
        stream.write("first\n")
        stream.flush()
        command = [sys.executable, "-c", "from service.cli import main; main()", *SMALL, "--format", "csv", "-o", name]
        subprocess.run(
            command,
            stdout=stream,
            stderr=subprocess.DEVNULL,
            timeout=120,
            check=True,
            cwd=tmp_path,
            env={**os.environ, "PYTHONPATH": str(ROOT)},
        )
    first, head, *rows = out.read_text().splitlines()
    assert (first, head.split(",")[0], len(rows)) == ("first", "model", 4)
    assert list(tmp_path.iterdir()) == [out]


@pytest.mark.parametrize("closed", ["1>&-", "2>&-"])
def test_a_stream_that_is_closed_is_no_error(closed):
    script = f'"$0" -c "from service.cli import main; main()" {" ".join(SMALL)} {closed}'
    done = subprocess.run(
        ["/bin/sh", "-c", script, sys.executable], capture_output=True, text=True, timeout=120, check=False
    )
    assert done.returncode == 0
    assert "Traceback" not in done.stderr
    assert ("variance" in done.stdout) == (closed == "2>&-")


def test_a_count_may_have_an_exponent():
    (plain,), (short,) = (
        numbers(result_of("stats", "--technique", "cosine", "--angles", "1", "--samples", count))
        for count in ("20000", "2e4")
    )
    assert plain == short


def test_a_wrong_command_names_those_there_are_and_none_shows_the_help():
    wrong, none = samplerscope("stat"), samplerscope()
    assert wrong.returncode == none.returncode == 2
    (line,) = wrong.stderr.strip().splitlines()
    assert "stat: allowed is one of info, stats" in line
    assert none.stderr.startswith("Usage: samplerscope")


@pytest.mark.parametrize("variable", ["VK_DRIVER_FILES", "VK_ICD_FILENAMES"])
def test_a_driver_setting_that_is_none_gets_one_line_and_exit_code_3(variable):
    done = samplerscope(*SMALL, env={variable: "/no/such/driver.json"})
    assert done.returncode == 3
    assert done.stdout == ""
    (line,) = done.stderr.strip().splitlines()
    assert variable in line


def test_files_get_the_format_of_their_suffix_and_the_table_still_shows(tmp_path):
    names = ["a.json", "b.csv", "c.npz", "d.vl.json", "e.svg", "f.png"]
    outputs = [part for name in names for part in ("-o", str(tmp_path / name))]
    done = samplerscope(*SMALL, *outputs)
    assert done.returncode == 0
    assert "mean weight" in done.stdout
    assert sorted(path.name for path in tmp_path.iterdir()) == names
    assert all(path.stat().st_size > 300 for path in tmp_path.iterdir())
    assert json.loads((tmp_path / "a.json").read_text())["kind"] == "statistics"
    assert "vega-lite" in json.loads((tmp_path / "d.vl.json").read_text())["$schema"]


def test_a_figure_is_a_named_scene(tmp_path):
    done = samplerscope("figure", "eon-13", "--samples", "1000", "-o", str(tmp_path / "f.svg"), "--format", "svg")
    assert done.returncode == 0
    assert (tmp_path / "f.svg").read_text().startswith("<svg")
    wrong = samplerscope("figure", "eon-12")
    assert wrong.returncode == 2
    assert "eon-11" in wrong.stderr


def test_info_names_the_driver_and_the_catalogue():
    found = result_of("info")
    assert "llvmpipe" in found["device"]["name"]
    assert {entry["name"] for entry in found["catalogue"]["techniques"]} >= {"cosine", "cltc-mis"}
    assert "red-velvet" in found["presets"]


def test_the_text_of_info_keeps_names_and_titles_apart():
    text = samplerscope("info").stdout
    for kind in ("models", "techniques"):
        for entry in result_of("info")["catalogue"][kind]:
            assert f"  {entry['name']}  " in text


def test_memory_does_not_grow_with_the_number_of_samples():
    """Peak resident memory of a run of 2^16 and of 2^28 samples; 20 MB is what allocators and thread timing vary by."""
    code = (
        "import resource, sys; from service.cli import cli; "
        "cli.main(sys.argv[1:], standalone_mode=False); "
        "print(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss, file=sys.stderr)"
    )
    peaks = []
    for samples in (2**16, 2**28):
        scene = f"stats --technique uniform --theta-o-deg 45 --samples {samples} --no-reference"
        done = subprocess.run(
            [sys.executable, "-c", code, *scene.split()], capture_output=True, text=True, timeout=120, check=True
        )
        peaks.append(int(done.stderr.splitlines()[-1]))
    assert peaks[1] - peaks[0] < 20_000


def test_a_small_question_loads_no_plotting_or_server_library():
    code = (
        "import sys; from service.cli import cli; cli.main(sys.argv[1:], standalone_mode=False); "
        "heavy = {'altair', 'vl_convert', 'fastapi', 'uvicorn', 'rich', 'scipy'}; "
        "print(sorted(heavy & set(sys.modules)), file=sys.stderr)"
    )
    done = subprocess.run(
        [sys.executable, "-c", code, *SMALL, "--no-reference"], capture_output=True, text=True, timeout=60, check=True
    )
    assert done.stderr.splitlines()[-1] == "[]"
