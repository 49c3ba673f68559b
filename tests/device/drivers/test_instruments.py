"""The amplifier and the encoder as seen by a bench, and a foreign supply as an example of another driver."""

import pytest

from device.drivers.scripted import Scripted
from device.drivers.supply import Supply
from smarig.config import load_rig
from smarig.core.catalogue import catalogue_entry, catalogue_names
from smarig.core.errors import ConfigError
from smarig.core.sample import Quality
from smarig.device.drivers import smarig_amplifier, smarig_encoder_daq
from smarig.device.drivers.scpi_supply import ScpiSupply, scpi_supply
from smarig.device.drivers.smarig_amplifier import SmarigAmplifier
from smarig.device.drivers.smarig_encoder_daq import SmarigEncoderDaq
from smarig.device.encoding.exchange import Refusal
from smarig.device.encoding.link_faults import Garbled, Refused, Silent, WrongDevice
from smarig.device.encoding.register import load_register_map

SETTINGS = {"period": 0.1, "lease": 1.0, "current_min": 0.0, "current_max": 1.0, "resistance_max": 20.0}
OFF, ARM = 2, 1


@pytest.fixture
def link():
    return Scripted(load_register_map("amplifier"))


def orders(link):
    return [d["order"] for d in link.done]


def test_opening_writes_settings_while_off_and_moves_nothing(link):
    SmarigAmplifier(link, SETTINGS)
    assert orders(link) == [OFF]
    kept = link.map.decode("settings", link.settings)
    assert (kept["period"], kept["lease"], kept["current_max"], kept["resistance_max"]) == (
        100,
        1000,
        1_000_000,
        20_000,
    )
    assert not any(d["current"] for d in link.done)


@pytest.mark.parametrize(
    ("driver", "other"), [(smarig_amplifier, "encoder_daq"), (smarig_encoder_daq, "amplifier")]
)
def test_a_device_that_is_another_is_let_go_of(driver, other, monkeypatch):
    link = Scripted(load_register_map(other))
    monkeypatch.setattr(driver, "opened", lambda *_: link)
    rig = load_rig("bench_one_wire")
    with pytest.raises(WrongDevice):
        getattr(driver, driver.__name__.rsplit(".", 1)[-1])(rig.links.amplifier, rig)
    assert link.closed == 1


def test_arming_comes_before_the_first_current_at_zero(link):
    """So an arm frame that arrives late heats nothing."""
    amplifier = SmarigAmplifier(link, SETTINGS)
    link.status["state"] = 1
    amplifier.set(0.25)
    amplifier.set(0.5)
    assert [(d["order"], d["current"]) for d in link.done[1:]] == [
        (ARM, 0),
        (0, 250_000),
        (0, 500_000),
    ]


@pytest.mark.parametrize("says", [{"state": 1, "output": 0}, {"state": 0, "output": 5}])
def test_off_is_confirmed_only_by_a_matching_status(link, says):
    amplifier = SmarigAmplifier(link, SETTINGS)
    assert amplifier.off() == ""
    link.status |= says
    said = amplifier.off()
    assert "reports that it still drives the wire" in said
    assert "lease switches it off within 1 s" in said
    assert orders(link)[-3:] == [OFF] * 3


@pytest.mark.parametrize(("first", "count"), [(3, 2), (10, 2), (0xFFFFFFF0, 2), (8, 3)])
def test_samples_that_cannot_be_those_requested_are_refused(link, first, count):
    """Asked for from tick 4 on, of a device that has counted 9."""
    amplifier = SmarigAmplifier(link, SETTINGS)
    link.status |= {"tick": 9, "ring_first": first, "ring_count": count}
    with pytest.raises(Garbled, match="Its ring buffer is inconsistent"):
        amplifier.since(4, 16)
    link.status |= {"ring_first": 5}
    assert [r.tick for r in amplifier.since(4, 16)] == list(range(5, 5 + count))


def test_reading_feeds_the_lease_with_the_same_current(link):
    amplifier = SmarigAmplifier(link, SETTINGS)
    link.status["state"] = 1
    amplifier.set(0.25)
    amplifier.since(9, 4)
    assert (link.done[-1]["current"], link.done[-1]["ring_next"], link.done[-1]["ring_want"]) == (
        250_000,
        9,
        4,
    )


def test_a_trip_is_reported_with_its_remedy_and_no_current_is_requested(link):
    amplifier = SmarigAmplifier(link, SETTINGS)
    link.status |= {"state": 2, "trip": 5}
    amplifier.since(1, 1)
    assert "short" in amplifier.tripped
    assert "between the clamps" in amplifier.tripped
    amplifier.since(2, 1)
    assert link.done[-1]["current"] == 0


def test_off_never_raises(link):
    amplifier = SmarigAmplifier(link, SETTINGS)
    link.gone = True
    amplifier.off()
    amplifier.off()


def test_a_refused_current_is_no_current(link):
    amplifier = SmarigAmplifier(link, SETTINGS)
    link.next_replies = [Refusal(3)]
    with pytest.raises(Refused):
        amplifier.set(5.0)


def test_the_encoder_writes_its_period_and_zeroes():
    link = Scripted(load_register_map("encoder_daq"))
    daq = SmarigEncoderDaq(link, 0.05)
    assert link.settings == [50]
    daq.zero()
    assert orders(link) == [1]


def test_every_driver_is_found_by_its_name():
    drivers = catalogue_names("smarig.device.drivers")
    assert {"smarig_amplifier", "smarig_encoder_daq", "scpi_supply"} <= set(drivers)
    assert all(callable(catalogue_entry("smarig.device.drivers", name)) for name in drivers)


# --- a supply that speaks SCPI, behind a pty ------------------------------------------------------------------------


@pytest.fixture
def supply():
    supply = Supply()
    yield supply
    supply.close()


def where(supply):
    links = load_rig("bench_one_wire").links
    assert links is not None
    return links.amplifier.model_copy(update={"url": supply.port, "driver": "scpi_supply", "timeout_s": 5.0})


def test_a_supply_drives_and_measures(supply):
    source = scpi_supply(where(supply), load_rig("bench_one_wire"))
    source.set(0.5)
    assert supply.heard[:6] == ["OUTP OFF", "*IDN?", "CURR 0", "OUTP OFF", "OUTP?", "VOLT 5.500"]
    readings = source.since(7, 3)
    assert [r.tick for r in readings] == [7, 8, 9]
    assert (readings[-1].current_A, readings[-1].voltage_V) == (0.5, 2.0)
    assert [r.quality for r in readings] == [Quality.STALE, Quality.STALE, Quality.GOOD]
    assert source.off() == ""
    assert source.since(10, 1)[0].current_A == 0.0
    assert supply.heard[-5:-2] == ["CURR 0", "OUTP OFF", "OUTP?"]
    source.close()


def test_a_supply_that_takes_another_current_is_switched_off(supply):
    source = ScpiSupply(where(supply), 24.0)
    supply.takes = 1.1
    with pytest.raises(Exception, match=r"accepted 0.55 A instead of the commanded 0.5 A"):
        source.set(0.5)
    source.since(1, 1)
    assert not supply.on
    source.close()


def test_a_reply_of_a_supply_that_is_not_a_number_is_refused(supply):
    source = ScpiSupply(where(supply), 24.0)
    supply.takes = float("nan")
    with pytest.raises(Garbled, match="answers 'nan' to CURR"):
        source.set(0.5)
    source.close()


def test_a_supply_that_stays_on_is_reported(supply):
    source = ScpiSupply(where(supply), 24.0)
    supply.stuck = True
    assert "switch it off by hand" in source.off()
    with pytest.raises(Silent, match="switch it off by hand"):
        source.arm()
    source.close()


def test_a_supply_that_was_left_on_is_off_before_it_is_identified(supply):
    supply.on, supply.identity = True, "hello"
    with pytest.raises(WrongDevice):
        ScpiSupply(where(supply), 24.0)
    assert not supply.on


def test_a_device_that_is_no_supply_is_reported(supply):
    supply.identity = "hello"
    with pytest.raises(WrongDevice, match="not an SCPI identity"):
        ScpiSupply(where(supply), 24.0)


def test_a_missing_port_is_reported(supply):
    with pytest.raises(Silent, match="cannot be opened"):
        ScpiSupply(where(supply).model_copy(update={"url": "/dev/there-is-none"}), 24.0)


def test_a_supply_is_not_for_two_wires(supply):
    with pytest.raises(ConfigError, match="one sign only"):
        scpi_supply(where(supply), load_rig("bench_two_wire"))
