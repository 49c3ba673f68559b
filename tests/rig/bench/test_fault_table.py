"""Every fault in every phase on every link is safe and clear: 0 A in time, the run closed, one message, no
hang.

By default, each fault runs once in lock-step, and three run on other links; of what happens to either device, one is
left out where it is slow. ``SMARIG_FAULTS=all`` runs the
whole product, and faults that need real time.
"""

import os

import pytest

from rig.bench.fault_cell import perform
from rig.bench.fault_judge import faulty
from rig.bench.fault_page import PAGE, page
from rig.bench.fault_rows import REPRESENTATIVE, ROWS
from rig.bench.fault_table import everyday, whole

WHOLE = os.environ.get("SMARIG_FAULTS") == "all"
CELLS = {
    c.name: c for c in (*everyday(ROWS, REPRESENTATIVE), *(whole(ROWS, REPRESENTATIVE) if WHOLE else ()))
}
LEFT_OUT = {  # slow, and tried on the other device or link
    *("dead line, encoder_daq, in a hold, serial", "dead line, amplifier, in a hold, serial"),
    *("everything garbled, amplifier, in a hold, serial", "power gone, amplifier, in a hold, serial"),
    *("late replies, in a hold, serial", "reboot, amplifier, in a hold, serial"),
    *("reboot, encoder_daq, in a hold, serial", "unplugged, encoder_daq, in a hold, serial"),
}
SLOW = pytest.mark.long("takes ten seconds; its kind is tried on the other device or link")
assert CELLS.keys() >= LEFT_OUT


@pytest.mark.skipif(os.name == "nt", reason="ptys and POSIX signals")
@pytest.mark.filterwarnings("ignore:set.* is deprecated:DeprecationWarning")  # pyserial's own, in rfc2217
@pytest.mark.parametrize(
    "name", [pytest.param(name, marks=SLOW) if name in LEFT_OUT and not WHOLE else name for name in CELLS]
)
def test_a_fault_is_safe_and_clear(name, tmp_path, capsys, monkeypatch):
    cell = CELLS[name]
    result = perform(cell, tmp_path, capsys, monkeypatch)
    assert faulty(cell, result) == []


def test_the_page_lists_what_is_tried():
    """``PYTHONPATH=tests python tests/rig/bench/fault_page.py`` writes it."""
    assert PAGE.read_text(encoding="utf-8") == page()
