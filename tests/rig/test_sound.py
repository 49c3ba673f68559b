"""A bench's rig file is checked for consistency before anything is opened."""

import pytest

from smarig.cli import run as cli
from smarig.config import load_rig, shipped_names
from smarig.core import ConfigError
from smarig.core.catalogue import own_files
from smarig.rig.consistency import check_lease, inconsistencies


@pytest.mark.parametrize("name", shipped_names("rigs"))
def test_shipped_rigs_are_sound(name):
    found = inconsistencies(load_rig(name))
    assert [problem for problem in found if "is the placeholder of the template" not in problem] == []


def test_an_address_of_a_template_is_reported(tmp_path):
    path = tmp_path / "mine.toml"
    path.write_text('name = "mine"\nbase = "bench_one_wire"\nlinks.amplifier.url = "/dev/ttyACM0"\n')
    assert inconsistencies(load_rig(str(path))) == [
        "links.encoder_daq.url is the placeholder of the template. Give the port or address of the device."
    ]


@pytest.mark.parametrize(
    ("line", "says"),
    [
        ('links.amplifier.driver = "smarig_amp"', "no driver 'smarig_amp'; did you mean smarig_amplifier?"),
        ('links.encoder_daq.url = ""', "links.encoder_daq.url is missing"),
        (
            'links.amplifier.url = "10.0.0.7:5025"',
            'A network address names its scheme: "tcp://10.0.0.7:5025".',
        ),
        ("links.amplifier.timeout_s = 0.5", "3 attempts take 1.5 s, longer than lease_s = 1"),
        ("lease_s = 5.0", "lease_s = 5 is outside 0.5…2 s"),
        ("protection.slew_max_A_per_s = 1.0", "is below limits.current_rate_A_per_s = 25"),
        ("protection.resistance_max_ohm = 3.0", "contain the wire's 4.5 … 5 ohm"),
        ("protection.heat_max_A2s = 0.5", "should be between 10 (a steady 1 A)"),
        ("protection.heat_max_A2s = 20.0", "should be between 10 (a steady 1 A)"),
    ],
)
def test_inconsistencies_are_reported(tmp_path, capsys, line, says):
    path = tmp_path / "mine.toml"
    links = ("amplifier", "encoder_daq")
    urls = "".join(f'links.{name}.url = "/dev/{name}"\n' for name in links if f"{name}.url" not in line)
    path.write_text(f'name = "mine"\nbase = "bench_one_wire"\n{urls}{line}\n', encoding="utf-8")
    assert [says in problem for problem in inconsistencies(load_rig(str(path)))] == [True]
    assert cli(["check", str(path), "--no-current"]) == 2
    assert says in capsys.readouterr().err


@pytest.mark.parametrize(
    ("lines", "says"),
    [
        ('links.amplifier.framing = "lines"', 'Devices on one port need framing = "modbus_rtu"'),
        ("links.amplifier.baud = 9600", "at 9600 and at 115200 baud"),
        ('links.amplifier.serial_format = "8E1"', "as 8E1 and as 8N1. Give both the same serial_format."),
        ("links.amplifier.address = 65\nlinks.encoder_daq.address = 65", "Give each device its own address."),
    ],
)
def test_links_that_cannot_share_a_port_are_reported(tmp_path, lines, says):
    path = tmp_path / "mine.toml"
    urls = "".join(f'links.{name}.url = "/dev/ttyACM0"\n' for name in ("amplifier", "encoder_daq"))
    path.write_text(f'name = "mine"\nbase = "uno_one_wire"\n{urls}{lines}\n', encoding="utf-8")
    assert [says in problem for problem in inconsistencies(load_rig(str(path)))] == [True]


@pytest.mark.parametrize(
    ("line", "says"),
    [
        ("period_s = 1.0", "period_s = 1 is too long for lease_s = 1"),
        ("links.amplifier.timeout_s = 1.5", "3 attempts take 4.5 s, longer than lease_s = 1"),
    ],
)
def test_a_lease_is_asked_for_where_there_is_one(tmp_path, monkeypatch, line, says):
    """A slow instrument of an own driver is refused when it is opened, if it turns out to have a lease."""
    monkeypatch.chdir(tmp_path)
    assert cli(["new", "driver", "slow_box"]) == 0
    links = ("amplifier", "encoder_daq")
    keys = {"driver": "./slow_box.py", "framing": "lines", "url": "tcp://10.0.0.7:1"}
    lines = [f'links.{name}.{key} = "{value}"' for name in links for key, value in keys.items()]
    path = tmp_path / "mine.toml"
    path.write_text("\n".join(['name = "mine"', 'base = "bench_one_wire"', line, *lines]), encoding="utf-8")
    with own_files():
        file = load_rig(str(path))
        assert inconsistencies(file) == []
    assert file.links is not None
    with pytest.raises(ConfigError, match=says):
        check_lease(file, file.links)
