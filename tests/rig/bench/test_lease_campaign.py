"""Hostile lines to both devices, and hosts that die: current ends with the lease, and nothing false is recorded.

``SMARIG_LEASE_POLLS`` sets the number of polls on each link (the long campaign: 10 000).
"""

import os

import pytest

from firmware.firmware_build import make
from rig.bench.hostile_line import LATE_s
from rig.bench.lease_campaign import LEASE_TICKS, Campaign
from rig.bench.wired_time import PERIOD_s

POLLS = int(os.environ.get("SMARIG_LEASE_POLLS", "300"))
SHARE = 0.1  # of the frames in each direction
LATEST_TICKS = round(LATE_s[1] / PERIOD_s)  # a frame of the host may be under way for so long when it dies


@pytest.fixture(scope="module")
def library(tmp_path_factory):
    return make(tmp_path_factory.mktemp("firmware"), "libsmarig_firmware.so", ("gcc",))


@pytest.mark.long("takes a second", cases=("lines-C",))
@pytest.mark.parametrize("language", ["Python", "C"])
@pytest.mark.parametrize("framing", ["lines", "modbus_rtu", "modbus_tcp"])
def test_no_line_keeps_a_current_alive_or_makes_a_sample_false(framing, language, request, monkeypatch):
    library = request.getfixturevalue("library") if language == "C" else None
    figures = Campaign(framing, library, SHARE, monkeypatch).run(POLLS)
    print(f"\n{framing}, {language}: {figures}")
    assert figures.deaths > POLLS / 200
    assert figures.good > POLLS / 3
    assert len(figures.faults) > 12
    assert figures.wrong == []
    assert figures.beyond_limits == 0
    assert max(figures.after_last_frame) <= LEASE_TICKS + 2
    assert max(figures.after_death) <= LEASE_TICKS + 2 + LATEST_TICKS
