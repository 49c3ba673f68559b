"""``smarig check`` on the Uno under simavr in real time: all of the bring-up, with its lease.

Part of .ci/long, for a machine that keeps real time; it takes two minutes.
"""

import pytest

from firmware.uno_twin import host_rig
from smarig.cli import run as cli

pytestmark = pytest.mark.long("real time")


def test_check_brings_it_up(uno, tmp_path, capsys):
    port = tmp_path / "port"
    uno("--speed", "1", "--link", str(port))
    rig = host_rig(tmp_path, str(port), simulator="{ start = false, speed = 1.0 }")
    status = cli(["check", str(rig), "--yes"])
    said = capsys.readouterr().out
    for check in ("devices", "at rest", "read-back", "resistance", "encoder direction", "lease", "re-arm"):
        assert f"[x] {check}:" in said, said
    assert status == 0
