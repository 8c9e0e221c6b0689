"""Names of formats, and files that are written whole or not at all."""

import math
import os
import stat
import subprocess
import sys

import pytest

from service.formats import FORMATS, UnknownFormat, encode, format_of, write, write_bytes
from tests.service.formats.statistics_results import awkward, six_techniques


@pytest.mark.parametrize(
    ("name", "format_"),
    [
        ("out/eon-11.vl.json", "vega"),
        ("a.VEGA.json", "vega"),
        ("a.json", "json"),
        ("a.CSV", "csv"),
        ("a.npz", "npz"),
        ("a.b.png", "png"),
        ("a.svg", "svg"),
        ("a.txt", "table"),
    ],
)
def test_the_suffix_names_the_format(name, format_):
    assert format_of(name) == format_


def test_an_unknown_suffix_or_format_is_answered_with_what_is_allowed_in_one_line():
    for call in (lambda: format_of("a.pdf"), lambda: encode(awkward(), "pdf")):
        with pytest.raises(UnknownFormat, match=r"allowed: .*csv.*npz") as caught:
            call()
        assert "\n" not in str(caught.value)


def test_a_kind_without_a_format_says_which_it_has():
    with pytest.raises(UnknownFormat, match="'nothing' has no format 'csv'; allowed: json"):
        encode({"kind": "nothing"}, "csv")
    assert encode({"kind": "nothing"}, "json") == b'{"kind": "nothing"}\n'


def test_every_format_that_is_not_binary_is_utf8():
    for name, entry in FORMATS.items():
        if not entry.binary:
            encode(awkward(), name).decode()


def test_a_file_is_written_with_its_folders_and_usual_permissions(tmp_path):
    path = tmp_path / "a" / "b" / "result.json"
    write(awkward(), path)
    assert path.read_bytes() == encode(awkward(), "json")
    mask = os.umask(0)
    os.umask(mask)
    assert stat.S_IMODE(path.stat().st_mode) == 0o666 & ~mask


def test_a_failing_encode_leaves_the_folder_as_it_was(tmp_path):
    path = tmp_path / "result.json"
    path.write_text("before")
    result = six_techniques(2)
    result["series"][0]["mean"][0] = math.nan
    with pytest.raises(ValueError, match="not finite"):
        write(result, path)
    assert [(entry.name, entry.read_text()) for entry in tmp_path.iterdir()] == [("result.json", "before")]


def test_a_failing_write_leaves_nothing_and_names_the_file(tmp_path, monkeypatch):
    def full(*_):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr("pathlib.Path.replace", full)
    with pytest.raises(OSError, match=r"No space left on device.*result\.csv"):
        write(awkward(), tmp_path / "result.csv")
    assert list(tmp_path.iterdir()) == []


def test_a_folder_in_the_way_is_an_os_error(tmp_path):
    (tmp_path / "file").write_text("")
    with pytest.raises(OSError, match="file"):
        write_bytes(tmp_path / "file" / "result.json", b"")
    with pytest.raises(IsADirectoryError):
        write_bytes(tmp_path, b"")


def test_a_link_stays_a_link_and_a_pipe_a_pipe(tmp_path):
    (tmp_path / "target.json").write_text("before")
    (tmp_path / "link.json").symlink_to("target.json")
    write_bytes(tmp_path / "link.json", b"after")
    assert (tmp_path / "link.json").is_symlink()
    assert (tmp_path / "target.json").read_text() == "after"
    write_bytes(os.devnull, b"nothing")
    assert not stat.S_ISREG(os.stat(os.devnull).st_mode)


def test_text_formats_need_no_drawing_library():
    code = (
        "import sys, service.formats as f; r = {'kind': 'statistics', 'series': []};"
        "[f.encode(r, n) for n in ('json', 'csv', 'table')];"
        "print([m for m in ('altair', 'vl_convert', 'rich', 'numpy') if m in sys.modules])"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"
