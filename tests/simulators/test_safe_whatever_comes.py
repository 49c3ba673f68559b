"""Arbitrary requests and readings: no current unless armed, within its limits, and a trip stays latched."""

from hypothesis import given
from hypothesis import strategies as st

from simulators.amplifier import Amplifier
from smarig.device.encoding.exchange import Exchange, Refusal
from smarig.device.encoding.register import load_register_map

MAP = load_register_map("amplifier")
currents = st.sampled_from([0, 1, 49_999, 300_000, -300_000, 1_000_000, 1_000_001, -5_000_000])
commands = st.builds(
    lambda order, current, again: ("command", order, current, again),
    st.integers(0, 3),
    currents,
    st.booleans(),
)
ticks = st.builds(
    lambda current, voltage, hardware: ("tick", current, voltage, hardware),
    currents,
    st.sampled_from([0, 100_000, 5_000_000, 50_000_000]),
    st.sampled_from([0, 0, 0, 1, 2]),
)


@given(st.lists(st.one_of(commands, ticks), max_size=60))
def test_no_current_unless_armed(steps):
    amplifier = Amplifier()
    limits = {"current_min": -500_000, "current_max": 1_000_000, "slew_max": 5_000, "heat_max": 150_000}
    settings = {r.name: r.safe or 0 for r in MAP.blocks["settings"]} | limits
    assert amplifier.accept(Exchange(write_at=0x200, words=tuple(MAP.encode("settings", settings)))) == []
    sequence = 1
    for kind, *values in steps:
        latched = amplifier.state == "tripped" and amplifier.trip
        if kind == "tick":
            amplifier.tick(values[0], values[1], 0, values[2])
            order = 0
        else:
            order, current, again = values
            sequence += not again
            raw = {"sequence": sequence, "epoch": 1, "order": order, "nonce": amplifier.arm_nonce}
            raw["current"] = current & 0xFFFFFFFF
            answer = amplifier.accept(Exchange(write_at=0x100, words=tuple(MAP.encode("command", raw))))
            order = 0 if isinstance(answer, Refusal) else order
        assert amplifier.state == "armed" or amplifier.output_uA == 0
        assert -500_000 <= amplifier.output_uA <= 1_000_000
        assert (amplifier.state == "tripped") == bool(amplifier.trip)
        if latched and order not in (2, 3):
            assert amplifier.trip == latched
