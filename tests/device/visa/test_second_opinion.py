"""The commands of makes.toml against those that PyMeasure's drivers send; skipped where PyMeasure is not installed."""

import re

import pytest

pytest.importorskip("pymeasure", reason="PyMeasure is not installed")

from pymeasure.adapters import Adapter
from pymeasure.instruments.keithley import Keithley2200, Keithley2400
from pymeasure.instruments.keysight import KeysightE36312A
from pymeasure.instruments.rohdeschwarz.hmp import HMP4040

from smarig.device.drivers._makes import filled, makes

MAKES = makes()
LONG = {"MEASURE": "MEAS", "VOLTAGE": "VOLT", "CURRENT": "CURR", "OUTPUT": "OUTP", "SOURCE": "SOUR"}
LONG |= {"SENSE": "SENS", "PROTECTION": "PROT"}


class Heard(Adapter):
    """Keeps what would be sent; answers 1."""

    def __init__(self):
        super().__init__()
        self.lines = []

    def _write(self, command, **kwargs):
        self.lines.append(command)

    def _read(self, **kwargs):
        return "1"


def plain(command):
    """Upper case, short forms, without spaces, leading colons, and the output that was selected before."""
    words = re.sub(r"[A-Za-z]+", lambda m: LONG.get(m.group().upper(), m.group().upper()), command)
    words = re.sub(r"^INST(:SEL)? ?(OUT|CH)1;", "", words.strip().lstrip(":"))
    return re.sub(r"\s|(?<=\d)\.0+$", "", words).lstrip(":").replace("ON", "1").replace("OFF", "0")


def ours(make, group, name):
    return plain(filled(getattr(getattr(MAKES[make], group), name), channel=1, value="0.25", largest="1"))


def said(instrument, adapter, act):
    adapter.lines.clear()
    act(instrument)
    return plain(adapter.lines[-1])


@pytest.mark.filterwarnings("default")
@pytest.mark.parametrize(
    ("make", "group", "name", "kind", "act"),
    [
        (
            "keysight_e36300",
            "current",
            "set",
            KeysightE36312A,
            lambda s: setattr(s.ch_1, "current_limit", 0.25),
        ),
        ("keysight_e36300", "current", "query", KeysightE36312A, lambda s: s.ch_1.current_limit),
        (
            "keysight_e36300",
            "voltage",
            "set",
            KeysightE36312A,
            lambda s: setattr(s.ch_1, "voltage_setpoint", 0.25),
        ),
        ("keysight_e36300", "measure", "current", KeysightE36312A, lambda s: s.ch_1.current),
        ("keysight_e36300", "measure", "voltage", KeysightE36312A, lambda s: s.ch_1.voltage),
        (
            "keysight_e36300",
            "output",
            "on",
            KeysightE36312A,
            lambda s: setattr(s.ch_1, "output_enabled", True),
        ),
        ("keysight_e36300", "output", "query", KeysightE36312A, lambda s: s.ch_1.output_enabled),
        ("keithley_2200", "current", "set", Keithley2200, lambda s: setattr(s.ch_1, "current_limit", 0.25)),
        ("keithley_2200", "measure", "current", Keithley2200, lambda s: s.ch_1.current),
        ("keithley_2200", "measure", "voltage", Keithley2200, lambda s: s.ch_1.voltage),
        ("rohde_schwarz_hmp", "current", "set", HMP4040, lambda s: setattr(s, "current", 0.25)),
        ("rohde_schwarz_hmp", "current", "query", HMP4040, lambda s: s.current),
        ("rohde_schwarz_hmp", "measure", "current", HMP4040, lambda s: s.measured_current),
        ("rohde_schwarz_hmp", "measure", "voltage", HMP4040, lambda s: s.measured_voltage),
        ("keithley_2400", "current", "set", Keithley2400, lambda s: setattr(s, "source_current", 0.25)),
        ("keithley_2400", "voltage", "set", Keithley2400, lambda s: setattr(s, "compliance_voltage", 0.25)),
        ("keithley_2400", "output", "query", Keithley2400, lambda s: s.source_enabled),
    ],
)
def test_pymeasure_sends_the_same(make, group, name, kind, act):
    adapter = Heard()
    instrument = kind(adapter)
    assert said(instrument, adapter, act) in (ours(make, group, name), "SOUR:" + ours(make, group, name))
