"""Drawing where the home folder cannot be written: no messages of the drawing library."""

import os
import subprocess
import sys

import pytest

CODE = "from smarig.report.drawing import WIDE_PX; import matplotlib.font_manager; print(WIDE_PX)"


@pytest.mark.long("takes three seconds")
@pytest.mark.skipif(os.name == "nt", reason="/dev/null is no folder")
def test_nothing_is_said_of_the_folder_of_matplotlib(tmp_path):
    nowhere = dict.fromkeys(("HOME", "XDG_CONFIG_HOME", "XDG_CACHE_HOME"), "/dev/null")
    kept = {key: value for key, value in os.environ.items() if key != "MPLCONFIGDIR"}
    environment = kept | nowhere | {"TMPDIR": str(tmp_path)}
    done = subprocess.run(
        [sys.executable, "-c", CODE], capture_output=True, text=True, check=False, env=environment
    )
    assert (done.returncode, done.stderr) == (0, "")
