"""What ends a worker is told for what it is."""

import pytest

from service.isolation import OwnFileFailed, run_isolated


def test_a_fault_of_the_tool_is_not_laid_on_the_file():
    with pytest.raises(OwnFileFailed, match="a fault of samplerscope itself, not of the file: KeyError: 'scene'"):
        run_isolated("statistics", {"device": None})
