"""Runs of own files in a process apart: whose fault an end is, and where the program may lie."""

import json
import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
import vulkan

from service.isolation import OwnFileFailed, run_isolated


def test_a_fault_of_the_tool_is_not_laid_on_the_file():
    with pytest.raises(OwnFileFailed, match="a fault of samplerscope itself, not of the file: KeyError: 'scene'"):
        run_isolated("statistics", {"device": None})


def test_a_program_that_only_root_may_read_runs_files_as_well(tmp_path):
    """Root becomes nobody before a file runs, and nobody may not enter a folder like /root."""
    root = Path(__file__).parents[3]
    private = tmp_path / "private"
    for folder in (root / "service", root / "lavapipe", root / "shaders", Path(vulkan.__file__).parent):
        shutil.copytree(folder, private / folder.name)
    private.chmod(0o700)
    (tmp_path / "mine.glsl").write_text((root / "shaders/techniques/cosine.glsl").read_text())
    options = ["--technique", f"{tmp_path / 'mine.glsl'},cltc-mis", "--theta-o-deg", "60", "--samples", "1024"]
    done = subprocess.run(
        [sys.executable, "-c", "from service.cli import main; main()", "stats", *options, "--format", "json"],
        cwd=private,
        env=os.environ | {"PYTHONPATH": str(private)},
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    mine, other = json.loads(done.stdout)["series"]
    assert mine["reference"]["mean"] == pytest.approx(other["reference"]["mean"], rel=1e-6)
