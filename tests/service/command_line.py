"""The command line as a user calls it: in a process of its own."""

import os
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).parents[2]


def samplerscope(*arguments, env=None, limit_s=300):
    """Run `samplerscope` with these arguments and variables beside the usual ones; its exit code and what it said."""
    command = [sys.executable, "-c", "from service.cli import main; main()", *map(str, arguments)]
    variables = {**os.environ, "PYTHONPATH": str(ROOT), **(env or {})}
    return subprocess.run(command, capture_output=True, text=True, timeout=limit_s, env=variables, check=False)
