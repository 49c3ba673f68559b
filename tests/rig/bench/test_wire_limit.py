"""The thermometer's limit in the amplifier: written when it is armed, trips in its tick, not in older firmware."""

import dataclasses

import pytest

from rig.bench import wired_bench
from rig.bench.wired_bench import FILE, Wired
from rig.bench.wired_time import FiveOhms
from simulators import register_device
from smarig.core.errors import ConfigError, LeaseExpired
from smarig.device.drivers.smarig_encoder_daq import SmarigEncoderDaq
from smarig.device.encoding.register import load_register_map

AMBIENT, NONE = 2200, -32768
LIMIT = AMBIENT + round(100 * FILE.limits.temperature_max_K)


class Warm(FiveOhms):
    """With a thermometer, in 0.01 °C."""

    temperature = AMBIENT

    def advance(self, output_A):
        return super().advance(output_A)._replace(temperature=self.temperature)


@pytest.fixture
def wired(monkeypatch):
    """A bench whose wire has a thermometer, after two ticks without current."""
    monkeypatch.setattr("rig.bench.wired_time.FiveOhms", Warm)
    bench = Wired("lines", monkeypatch)
    bench.step(0.0)
    bench.step(0.0)
    return bench


def limit(wired):
    return wired.world.amplifier.stored["wire_temperature_max"]


def wire(wired):
    return wired.world.bench._wire


def two_steps(wired):
    for _ in range(2):
        wired.step(0.3)


def test_the_host_writes_it_when_it_arms(wired):
    assert (limit(wired), wired.bench.holds_wire_limit) == (NONE, True)
    assert wired.work() is None
    assert limit(wired) == LIMIT
    assert {s.quality for s in wired.samples} == {0}


def test_a_wire_at_its_limit_goes_on_and_one_above_it_trips_in_its_tick(wired):
    wired.step(0.3)
    wire(wired).temperature = LIMIT
    wired.step(0.3)
    assert wired.world.amplifier.state == "armed"
    wire(wired).temperature, ticks = LIMIT + 1, wired.world.ticks
    wired.step(0.3)
    assert wired.world.amplifier.trip == "wire_temperature"
    assert not any(wired.world.driven_uA[ticks + 2 :])
    wire(wired).temperature = AMBIENT
    with pytest.raises(LeaseExpired, match="wire_temperature. The measured wire temperature exceeded"):
        two_steps(wired)
    assert (wired.world.amplifier.state, wired.world.amplifier.output_uA) == ("tripped", 0), "latched"
    wired.bench.arm()
    assert limit(wired) == NONE
    wired.step(0.3)
    assert (wired.world.amplifier.output_uA, limit(wired)) == (300_000, LIMIT)


def test_a_thermometer_that_reads_no_more_trips_also_after_the_next_arming(wired):
    wired.step(0.3)
    wire(wired).temperature = NONE
    wired.step(0.3)
    assert wired.world.amplifier.trip == "wire_temperature"
    wired.bench.arm()
    assert wired.world.amplifier.trip == ""
    with pytest.raises(LeaseExpired, match="wire_temperature"):
        two_steps(wired)


def test_without_a_thermometer_nothing_is_written(monkeypatch):
    wired = Wired("lines", monkeypatch)
    assert wired.work() is None
    assert (limit(wired), wired.bench.holds_wire_limit) == (NONE, False)


def test_a_current_in_the_first_step_finds_it_too(monkeypatch):
    monkeypatch.setattr("rig.bench.wired_time.FiveOhms", Warm)
    wired = Wired("lines", monkeypatch)
    wired.world.time.sleep(0.3)
    wired.bench.arm()
    wired.bench.tick = wired.bench.sensor.tick()
    wired.step(0.3)
    assert limit(wired) == LIMIT


def test_a_thermometer_that_gives_its_first_reading_after_arming_is_limited_from_then_on(monkeypatch):
    monkeypatch.setattr("rig.bench.wired_time.FiveOhms", Warm)
    monkeypatch.setattr(Warm, "temperature", NONE)
    wired = Wired("lines", monkeypatch)
    wired.step(0.3)
    wired.step(0.3)
    assert (limit(wired), wired.bench.holds_wire_limit) == (NONE, False)
    wire(wired).temperature = AMBIENT
    wired.step(0.3)
    wired.step(0.3)
    assert (limit(wired), wired.world.amplifier.output_uA) == (LIMIT, 300_000)
    orders = wired.world.amplifier.arm_nonce
    wired.step(0.3)
    assert wired.world.amplifier.arm_nonce == orders, "armed once more, and not again"
    assert {s.quality for s in wired.samples} == {0}
    wire(wired).temperature = LIMIT + 1
    with pytest.raises(LeaseExpired, match="wire_temperature"):
        two_steps(wired)


def test_firmware_of_map_version_4_works_without_it(monkeypatch):
    now = load_register_map("amplifier")
    added = {name for name, r in now.registers.items() if r.since > now.first_version}
    old = dataclasses.replace(
        now,
        device=now.device.model_copy(update={"version": 4, "since": 0}),
        registers={name: r for name, r in now.registers.items() if name not in added},
        blocks={name: tuple(r for r in block if r.name not in added) for name, block in now.blocks.items()},
        faults={code: f for code, f in now.faults.items() if not f.since},
    )
    assert (added, old.size("settings"), old.hash) == ({"wire_temperature_max"}, 15, 0xF4DD445B)
    maps = {"amplifier": old, "encoder_daq": load_register_map("encoder_daq")}
    monkeypatch.setattr(register_device, "load_register_map", maps.__getitem__)
    monkeypatch.setattr("rig.bench.wired_time.FiveOhms", Warm)
    boot = register_device.RegisterDevice.boot

    def booted(device, boot_count):
        boot(device, boot_count)
        device.stored.setdefault(
            "wire_temperature_max", NONE
        )  # no register: the device of today looks for it

    monkeypatch.setattr(register_device.RegisterDevice, "boot", booted)
    wired = Wired("lines", monkeypatch)
    wired.step(0.0)
    assert wired.work() is None
    assert {s.quality for s in wired.samples} == {0}
    assert (limit(wired), wired.bench.holds_wire_limit) == (NONE, False)
    assert wired.samples[-1].temperature_degC == 22.0
    assert "map version 4, hash F4DD445B" in wired.source.identity


def test_a_limit_beyond_the_register_is_refused_in_one_sentence(monkeypatch):
    hot = FILE.model_copy(update={"limits": FILE.limits.model_copy(update={"temperature_max_K": 305.68})})
    monkeypatch.setattr(wired_bench, "FILE", hot)
    monkeypatch.setattr("rig.bench.wired_time.FiveOhms", Warm)
    wired = Wired("lines", monkeypatch)
    wired.step(0.0)
    wired.step(0.0)
    with pytest.raises(
        ConfigError, match=r"to at most 327.67 °C, not to 327.68 °C. Lower limits.temperature_max_K.$"
    ):
        wired.step(0.3)
    assert (wired.world.amplifier.output_uA, wired.world.amplifier.state) == (0, "off")


@pytest.mark.parametrize("wrong_degC", [320.0, -320.0, 60.0])
def test_the_limit_in_the_amplifier_is_that_of_a_room(wired, monkeypatch, wrong_degC):
    since = SmarigEncoderDaq.since

    def wrong(*range_):
        return [reading._replace(ambient_degC=wrong_degC) for reading in since(*range_)]

    monkeypatch.setattr(SmarigEncoderDaq, "since", wrong)
    for _ in range(3):
        wired.step(0.0)
    wired.step(0.3)
    assert limit(wired) == LIMIT
