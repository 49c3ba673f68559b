"""The simulators as a process: ports that open, time that passes, hosts that end.

The tests wait for conditions and measure times only with ``SMARIG_LONG``.
"""

import csv
import os
import shutil
import subprocess
import time
from pathlib import Path

import pytest
from talks import PATIENCE_S, Talk

from smarig.core.resources import shipped
from smarig.device.encoding import lines
from smarig.device.encoding.exchange import Exchange, Refusal
from smarig.device.encoding.register import load_register_map

AMPLIFIER = load_register_map("amplifier")
DAQ = load_register_map("encoder_daq")
STATUS = 25  # words of the amplifier's status block before its ring
ARM = {"order": 1, "nonce": 1 << 16}  # boot 1, no order yet
LONG = bool(os.environ.get("SMARIG_LONG"))  # and a machine that keeps real time


def settings(lease_ms: int = 500, **others: int) -> Exchange:
    """All of the amplifier's settings."""
    values = {r.name: r.safe or 0 for r in AMPLIFIER.blocks["settings"]}
    values |= {
        "lease": lease_ms,
        "current_max": 1_000_000,
        "slew_max": 25_000,
        "heat_max": 50_000_000,
        **others,
    }
    return Exchange(write_at=0x200, words=tuple(AMPLIFIER.encode("settings", values)))


def command(sequence: int, **values: int) -> Exchange:
    """A command to the amplifier, and the head of its status."""
    raw = {"sequence": sequence, "epoch": 1, **values}
    return Exchange(0, STATUS, 0x100, tuple(AMPLIFIER.encode("command", raw)))


def sample(sequence: int, tick: int, want: int = 1) -> Exchange:
    """Samples of the DAQ, of which the first is read."""
    raw = {"sequence": sequence, "epoch": 1, "ring_next": tick, "ring_want": want}
    return Exchange(0, 21, 0x100, tuple(DAQ.encode("command", raw)))


def status(talk: Talk) -> dict[str, int]:
    """Of the amplifier."""
    return AMPLIFIER.decode("status", talk.ask(Exchange(0, STATUS)))


def rows(path: Path) -> list[dict[str, str]]:
    """Of a trace."""
    with path.open(encoding="utf-8") as file:
        return list(csv.DictReader(file))


def test_lock_step_then_the_host_dies_and_the_lease_trips(devices, tmp_path):
    trace = tmp_path / "trace.csv"
    started = devices("--lock-step", "--trace", str(trace))
    amplifier, daq = Talk(started.url("amplifier")), Talk(started.url("encoder_daq"))
    assert amplifier.line("r 1 1").startswith("= 5341 *")
    assert amplifier.line("rubbish").startswith("! 9 *")
    assert amplifier.ask(settings()) == []
    assert not isinstance(amplifier.ask(command(1, **ARM, current=900_000)), Refusal)
    for tick in range(1, 6):
        amplifier.ask(command(1 + tick, current=900_000))  # fed before the tick, last of all before tick 5
        words = daq.ask(sample(tick, tick))
        assert DAQ.decode("status", words)["ring_count"] == 1
    assert status(amplifier)["tick"] == 5
    assert len(rows(trace)) == 5
    amplifier.close()
    daq.close()
    assert started.host_dies() == 0
    felt = {int(row["tick"]): row for row in rows(trace)}
    assert {felt[tick]["output_uA"] for tick in range(1, 11)} == {"900000"}
    assert [felt[tick]["state"] for tick in (9, 10)] == ["armed", "tripped"]  # 4 + 5 + 1
    assert {(row["output_uA"], row["trip"]) for tick, row in felt.items() if tick > 10} == {("0", "lease")}
    if LONG:
        wall_s = [float(row["wall_s"]) for tick, row in felt.items() if tick > 6]
        assert all(0.03 < b - a < 0.3 for a, b in zip(wall_s, wall_s[1:]))


def test_a_host_that_sends_nothing_trips_the_lease_while_its_ports_are_open(devices, tmp_path):
    trace = tmp_path / "trace.csv"
    amplifier = Talk(devices("--lock-step", "--gone-after", "1", "--trace", str(trace)).url("amplifier"))
    amplifier.ask(settings())
    amplifier.ask(command(1, **ARM, current=900_000))
    _wait(lambda: any(row["trip"] == "lease" for row in rows(trace)))
    seen = status(amplifier)
    assert (seen["state"], seen["trip"], seen["output"]) == (2, 1, 0)


def test_time_passes_by_itself_and_ends_by_a_signal(devices):
    started = devices("--speed", "20", "--framing", "modbus_rtu", "--effect", "creep=2", "--seed", "3")
    amplifier = Talk(started.url("amplifier"), AMPLIFIER.device.default_address)
    first, began = status(amplifier)["tick"], time.monotonic()
    amplifier.say(b"\x41\x03\x00")  # a piece of a frame: two milliseconds of silence end it
    _wait(lambda: amplifier.ask(Exchange(1, 1), timeout_s=0.5) == [AMPLIFIER.device.kind])
    _wait(lambda: status(amplifier)["tick"] >= first + 100)
    passed_s = time.monotonic() - began
    assert not LONG or abs(status(amplifier)["tick"] - first - 200 * passed_s) < 30
    started.process.terminate()
    assert started.process.wait(timeout=60) == 0


def test_unplugged_and_plugged_in_again_under_the_same_name(devices, tmp_path):
    """From tick 300 to 600; the test requests these samples meanwhile."""
    faults = tmp_path / "faults.toml"
    faults.write_text('[[fault]]\nkind = "unplugged"\ndevice = "amplifier"\nfrom_s = 30\nto_s = 60\n')
    started = devices("--lock-step", "--faults", str(faults), "--folder", str(tmp_path / "ports"))
    path, daq = Path(started.url("amplifier")), Talk(started.url("encoder_daq"))

    def passes(begin: int, end: int) -> None:
        for tick in range(begin, end, 20):
            assert daq.ask(sample(tick, tick, 20))[8] == tick

    before = Talk(str(path))
    passes(1, 281)
    assert status(before)["tick"] == 280
    passes(281, 301)
    _wait(lambda: not path.exists())
    with pytest.raises(OSError, match="rror"):
        os.write(before.channel, b"r 0 1\n")
    passes(301, 581)
    assert not path.exists()
    passes(581, 601)
    _wait(path.exists)
    assert status(Talk(str(path)))["tick"] == 600


def _wait(condition) -> None:
    end_s = time.monotonic() + PATIENCE_S
    while not condition():
        assert time.monotonic() < end_s
        time.sleep(0.002)


def test_late_and_lost_replies_over_a_real_line(devices, tmp_path):
    """Requests sent together are answered in order, a late reply before the next; a lost one has been
    executed."""
    faults = tmp_path / "faults.toml"
    late = '[[fault]]\nkind = "delayed"\ndevice = "amplifier"\ndelay_s = 0.2\nfrom_exchange = 2\nto_exchange = 3\n'
    lost = '[[fault]]\nkind = "dropped"\ndevice = "amplifier"\nfrom_exchange = 4\nto_exchange = 5\n'
    faults.write_text(late + lost)
    amplifier = Talk(devices("--lock-step", "--faults", str(faults)).url("amplifier"))

    def asked(*exchanges: Exchange, replies: int) -> list[str]:
        amplifier.say(b"".join(map(lines.request, exchanges)))
        heard = amplifier.hear(lambda heard: heard.count(b"\n") == replies)
        return [line.rpartition(" *")[0] for line in heard.decode().splitlines()]

    assert amplifier.ask(Exchange(1, 1)) == [0x5341]
    assert asked(Exchange(1, 1), Exchange(2, 1), replies=2) == ["= 5341", "= 0005"]
    assert asked(command(9), Exchange(7, 2), replies=1) == ["= 0000 0009"]


@pytest.mark.long("one of many cases", but_first=True)
@pytest.mark.parametrize(
    ("options", "blamed"),
    [
        (("--rig", "nowhere"), "nowhere"),
        (("--effect", "magic=1"), "magic"),
        (("--lock-step", "--speed", "2"), "--lock-step"),
        (("--device-library", __file__), "library"),
    ],
)
def test_mistakes_are_a_sentence_and_exit_status_2(devices, options, blamed):
    started = devices(*options)
    assert started.process.wait(timeout=60) == 2
    said = started.process.stderr.read()
    assert blamed in said
    assert "Traceback" not in said


def test_the_c_firmware_in_place_of_the_python_devices(devices, tmp_path):
    if not shutil.which("gcc"):
        pytest.skip("gcc is not installed")
    folder, library = shipped("firmware_protocol") / "firmware", tmp_path / "firmware.so"
    sources = [*folder.glob("core/*.c"), folder / "host" / "smarig_firmware.c"]
    subprocess.run(
        ["gcc", "-shared", "-fPIC", *map(str, sources), "-I", str(folder), "-o", str(library)], check=True
    )
    seen = []
    for options in ((), ("--device-library", str(library))):
        started = devices("--lock-step", "--framing", "modbus_rtu", *options)
        amplifier = Talk(started.url("amplifier"), AMPLIFIER.device.default_address)
        daq = Talk(started.url("encoder_daq"), DAQ.device.default_address)
        heard = [amplifier.ask(settings()), amplifier.ask(command(1, **ARM, current=900_000))]
        for tick in range(1, 200):
            heard.append(amplifier.ask(command(1 + tick, current=900_000, ring_next=tick - 1, ring_want=1)))
            heard.append(daq.ask(sample(tick, tick)))
        seen.append(heard)
    assert seen[0] == seen[1]
    assert DAQ.records(seen[0][-1], 1)[0][0] > 100  # the wire has moved
