"""Standard output on a full disk: one sentence, a status that is not zero, and no traceback."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

FULL = Path("/dev/full")
pytestmark = pytest.mark.skipif(not FULL.exists(), reason="/dev/full is a device of Linux")


@pytest.mark.parametrize(
    ("arguments", "status"), [(["list", "--json"], 4), (["--help"], 4), (["no_command", "--json"], 2)]
)
def test_a_full_standard_output_is_one_sentence(arguments, status):
    environment = {k: v for k, v in os.environ.items() if k != "PYTHONUNBUFFERED"}
    with FULL.open("w") as full:
        done = subprocess.run(
            [sys.executable, "-m", "smarig", *arguments],
            stdout=full,
            stderr=subprocess.PIPE,
            text=True,
            check=False,
            env=environment,
        )
    assert done.returncode == status
    assert done.stderr.count("\n") == 1
    assert "No space left on device" in done.stderr or status == 2


def test_a_full_standard_error_changes_nothing(capfd):
    with FULL.open("w") as full:
        done = subprocess.run(
            [sys.executable, "-m", "smarig", "no_command"], stderr=full, stdout=subprocess.PIPE, check=False
        )
    assert done.returncode == 2
