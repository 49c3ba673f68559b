"""Late, garbled, dropped and noisy replies on every link: no wrong value is accepted, no poll is lost,
nothing hangs.

``SMARIG_POLLS`` sets the number of polls (the long campaign: 100 000 per link). The devices run in
lock-step.
"""

import os
import time

import pytest

from smarig.config import load_rig
from smarig.core.sample import Quality
from smarig.plant.actuator import Actuator
from smarig.rig.open_rig import open_rig
from smarig.rig.twin import Twin, TwinSettings

LONG = "SMARIG_POLLS" in os.environ
POLLS = int(os.environ.get("SMARIG_POLLS", "200"))
TIMEOUT_S = 0.05 if LONG else 0.4  # six in a row are longer than a busy machine keeps devices waiting
SHARE = 0.01
FAULTS = """
[[fault]]
kind = "{kind}"
device = "{device}"
share = {share}
seed = {seed}
{more}
"""
BAD = {"dropped": "", "garbled": "", "delayed": f"delay_s = {1.5 * TIMEOUT_S}", "foreign_bytes": ""}
KINDS = {
    "serial": BAD,
    "modbus_rtu": BAD,
    "modbus_tcp": {
        "dropped": "",
        "delayed": BAD["delayed"],
        "repeated": "",
    },  # its own checksum keeps it whole
}
SELDOM = [] if LONG else pytest.mark.long("takes five seconds; the whole campaign takes every link")


def rig(folder, link):
    """A bench whose both lines are bad."""
    faults = folder / "faults.toml"
    faults.write_text(
        "".join(
            FAULTS.format(kind=kind, device=device, share=SHARE, seed=10 * n + m, more=more)
            for n, (kind, more) in enumerate(KINDS[link].items())
            for m, device in enumerate(("amplifier", "encoder_daq"))
        )
    )
    links = "".join(
        f'[links.{d}]\ndriver = "smarig_{d}"\nframing = "{load_rig(f"one_wire_{link}").links.amplifier.framing}"\n'
        f"timeout_s = {TIMEOUT_S}\n"
        for d in ("amplifier", "encoder_daq")
    )
    path = folder / "bad.toml"
    path.write_text(f'name = "bad"\nbase = "one_wire_{link}"\n{links}[simulator]\nfaults = "{faults}"\n')
    return str(path)


@pytest.mark.long("takes a second", cases=("serial",))
@pytest.mark.parametrize(
    "link",
    ["serial", *(pytest.param(name, marks=SELDOM) for name in ("modbus_tcp", "modbus_rtu"))],
)
def test_a_bad_line_costs_time_and_nothing_else(link, tmp_path):
    name = rig(tmp_path, link)
    file = load_rig(name)
    actuator = Actuator.named(file.actuator)
    twin = Twin(file, actuator, TwinSettings(seed=5))
    retried, begun = 0, time.monotonic()
    with open_rig(name, file, actuator, TwinSettings(seed=5)) as bench:
        for k in range(POLLS):
            current_A = 0.5 if k // 100 % 2 else 0.0
            (result,), (true,) = bench.step(current_A), twin.step(current_A)
            retried += bool(result.quality & Quality.RETRIED)
            assert result._replace(
                quality=result.quality & ~Quality.RETRIED, temperature_degC=0.0
            ) == true._replace(temperature_degC=0.0)
    assert retried > 0.3 * SHARE * POLLS, "the line was bad"
    assert not LONG or time.monotonic() - begun < 30 + POLLS * 0.05
