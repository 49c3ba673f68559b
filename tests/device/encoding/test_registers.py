"""The register maps: internal consistency, and no register defined twice."""

import math
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from smarig.core.errors import ConfigError, UsageError
from smarig.core.toml_file import check_table
from smarig.device.encoding.generate import DEVICES, header, outdated, reference
from smarig.device.encoding.register import (
    VALUE_RANGES,
    Register,
    Value,
    from_words,
    load_register_map,
    to_words,
)

MAPS = [load_register_map(name) for name in DEVICES]
VALUES = [r.value for m in MAPS for r in m.registers.values() if not r.field] + [
    f for m in MAPS for r in m.registers.values() for f in r.field
]


@pytest.mark.parametrize("value", VALUES, ids=lambda v: f"{v.name}-{v.type}")
@given(st.data())
def test_what_a_register_holds_comes_back(value, data):
    raw = data.draw(st.integers(*VALUE_RANGES[value.type]).filter(lambda raw: raw != value.none))
    assert value.encode(value.decode(raw)) == raw
    assert from_words(to_words(raw, value.words), value.type) == raw


def test_a_value_is_rounded_to_the_nearest_and_refused_beyond_the_words():
    current = load_register_map("amplifier")["current"].value
    assert current.rounded(0.1234564) == 0.123456
    assert current.rounded(0.8) == 0.8
    assert math.isnan(current.rounded(math.nan))
    with pytest.raises(UsageError, match="current = 3000 A must be between"):
        current.encode(3000.0)


def test_no_reading_is_not_a_number():
    temperature = next(f for f in load_register_map("amplifier")["ring"].field if f.name == "temperature")
    assert math.isnan(temperature.decode(temperature.none))
    assert temperature.decode(2150) == 21.5


@pytest.mark.parametrize("m", MAPS, ids=DEVICES)
def test_blocks_fit_one_exchange_and_begin_with_what_proves_freshness(m):
    assert m.size("status") <= 125
    assert m.size("command") <= 121
    assert [r.name for r in m.blocks["command"]][:2] == ["sequence", "epoch"]
    assert m["echo"].type == m["sequence"].type == m["epoch"].type == m["boot_count"].type == "u32"
    assert all(r.access == "rw" for block in ("command", "settings") for r in m.blocks[block])


@pytest.mark.parametrize("m", MAPS, ids=DEVICES)
def test_hosts_and_devices_of_any_version_can_tell_whom_to_update(m):
    """These places never change, and the heads of all versions are whole values of this one."""
    assert [m[name].address for name in ("kind", "version", "map_hash")] == [1, 2, 3]
    former = {"amplifier": 23, "encoder_daq": 15}[m.device.name]
    starts = {r.address for r in m.blocks["status"]}
    assert former in starts


@pytest.mark.parametrize("m", MAPS, ids=DEVICES)
def test_a_block_comes_back_from_its_words(m):
    values = {r.name: r.limits[1] for r in m.blocks["settings"]}
    assert m.decode("settings", m.encode("settings", values)) == values


def test_the_hash_distinguishes_maps_but_not_their_texts():
    first, second = MAPS
    assert first.hash != second.hash
    assert "switches off" not in first.canonical
    assert "register current 0105 i32 rw 1e-06 A" in first.canonical


def test_the_header_and_the_reference_are_up_to_date():
    assert outdated(write=False) == []


def test_the_header_and_the_reference_name_every_register():
    for m in MAPS:
        for r in m.registers.values():
            assert f"_{r.name.upper()} 0x{r.address:04X}u" in header()
            assert f"`{r.name}`" in reference()
        assert f"0x{m.hash:08X}ul" in header()


def test_a_map_that_cannot_be_is_refused():
    for wrong in (
        {"name": "x", "address": 0, "type": "record", "access": "r", "text": ""},
        {"name": "x", "address": 0, "type": "u16", "access": "rw", "text": ""},
        {"name": "x", "address": 70000, "type": "u16", "access": "r", "text": ""},
        {"name": "x", "address": 0, "type": "u64", "access": "r", "text": ""},
    ):
        with pytest.raises(ConfigError):
            check_table(Register, wrong, "map")
    with pytest.raises(UsageError, match="no register 'colour'"):
        MAPS[0]["colour"]


def test_no_address_is_written_anywhere_else():
    """Registers are defined once: nothing in Python names an address of theirs."""
    root = Path(__file__).parents[3]
    addresses = {f"0x{r.address:04X}" for m in MAPS for r in m.registers.values() if r.address >= 0x100}
    for path in [*(root / "src").rglob("*.py"), *(root / "simulators").rglob("*.py")]:
        text = path.read_text(encoding="utf-8")
        assert not [a for a in addresses if a in text or a.lower() in text], path


def test_every_value_has_a_description():
    assert all(isinstance(v, Value) and v.text.endswith(".") for v in VALUES)
