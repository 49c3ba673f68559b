"""What a session locks: nothing for twins; the wire and every line of devices that outlive it."""

import json
import os
import socket
import subprocess
import sys
from contextlib import ExitStack
from pathlib import Path

import pytest

from runner.interrupted import cut
from runner.lasting_devices import rig_file, started
from smarig.cli import run as cli
from smarig.config import load_rig
from smarig.core.errors import InUse
from smarig.record import load_run
from smarig.runner.line_keys import line_keys
from smarig.runner.listener import CallbackListener
from smarig.runner.lock import rig_locks
from smarig.runner.resume.resume_run import resume
from smarig.runner.session import Session

LINES = ("tcp://10.0.0.5", "tcp://10.0.0.6")


@pytest.fixture(autouse=True)
def lock_folder(tmp_path, monkeypatch) -> Path:
    monkeypatch.setenv("SMARIG_LOCK_DIR", str(tmp_path / "locks"))
    return tmp_path / "locks"


def rig(tmp_path, name, urls=LINES, wire="A7"):
    path = rig_file(tmp_path / f"{name}.toml", dict(zip(("amplifier", "encoder_daq"), urls)), wire=wire)
    return load_rig(str(path))


def test_twins_and_devices_of_the_session_lock_nothing(tmp_path, lock_folder):
    """A notebook and a terminal simulate side by side, on one rig file."""
    with Session("one_wire_twin") as one, Session("one_wire_twin") as other:
        one.run("validation", {"points": "2"}, tmp_path / "a.run.sqlite")
        other.run("validation", {"points": "2"}, tmp_path / "b.run.sqlite")
    for name in ("one_wire_serial", "one_wire_twin"):
        with rig_locks(load_rig(name), "w"), rig_locks(load_rig(name), "w"):
            pass
    assert not lock_folder.exists() or not list(lock_folder.iterdir())


@pytest.mark.long("takes a second")
def test_two_processes_simulate_the_same_wire_at_once(tmp_path):
    out = tmp_path / "b.run.sqlite"
    words = ["run", "validation", "--rig", "one_wire_twin", "--set", "points=2", "-o", str(out)]
    with Session("one_wire_twin"):
        done = subprocess.run([sys.executable, "-m", "smarig", *words], capture_output=True, check=False)
    assert done.returncode == 0, done.stderr
    assert load_run(out).cause == "done"


@pytest.mark.parametrize(
    ("urls", "wire", "says"),
    [
        (("tcp://10.0.0.7", "tcp://10.0.0.8"), "A7", "Wire 'A7' is in use by process"),
        (("tcp://10.0.0.7", "tcp://10.0.0.6:502"), "B", "The line tcp://10.0.0.6:502 is in use by process"),
        (("socket://10.0.0.5:502", "tcp://10.0.0.8"), "B", "The line socket://10.0.0.5:502 is in use by"),
    ],
)
def test_a_rig_that_shares_a_wire_or_a_line_is_refused(tmp_path, urls, wire, says):
    with (
        rig_locks(rig(tmp_path, "first"), "A7"),
        pytest.raises(InUse, match=rf"^{says}.*{os.getpid()} since .*Wait until it has ended"),
        rig_locks(rig(tmp_path, "second", urls, wire), wire),
    ):
        pytest.fail("two rigs on one line")


def test_what_was_locked_before_a_refusal_is_free_again(tmp_path):
    pairs = {"a": (1, 2), "b": (2, 3), "c": (3, 4)}
    first, second, third = (
        rig(tmp_path, name, [f"tcp://10.0.0.{k}" for k in pair]) for name, pair in pairs.items()
    )
    with rig_locks(first, "A"):
        with pytest.raises(InUse), rig_locks(second, "B"):
            pass
        with rig_locks(third, "B"):
            pass


def test_two_units_on_one_line_are_one_lock(tmp_path):
    """Amplifier and encoder with two Modbus addresses: the session does not lock itself out."""
    with rig_locks(rig(tmp_path, "one", ("tcp://gateway", "tcp://gateway:502")), "A7"):
        pass


@pytest.mark.parametrize(
    "same",
    [
        (
            "tcp://localhost",
            "tcp://127.0.0.1:502",
            "tcp://[::1]",
            "socket://LOCALHOST.:502",
            "tcp://127.0.1.1",
            "tcp://rig.localhost",
        ),
        (
            "tcp://[::ffff:10.0.0.5]:7",
            "rfc2217://10.0.0.5:7/?ign_set_control",
            "socket://10.0.0.5:7?logging=debug",
        ),
        ("tcp://Gateway.lab", "tcp://gateway.lab.:502"),
        ("GPIB0::24::INSTR", "GPIB::24::INSTR", "gpib0::24::instr", "GPIB0::0x18", " GPIB00::024 "),
        ("GPIB1::24::96::INSTR", "gpib1::24::96"),
        ("TCPIP0::10.0.0.5::inst0::INSTR", "TCPIP::10.0.0.5", "tcpip1::10.0.0.5::hislip0,4880::instr"),
        ("TCPIP::[fe80::1]::INSTR", "tcpip0::[FE80:0::1]::INST0"),
        ("TCPIP0::gateway.::gpib0,5::INSTR", "tcpip::GATEWAY::GPIB0,5"),
        ("TCPIP0::10.0.0.5::1234::SOCKET", "TCPIP::10.0.0.5::1234::socket", "tcp://10.0.0.5:1234"),
        (
            "USB0::0x1AB1::0x0E11::DP8C1234::INSTR",
            "USB0::6833::3601::DP8C1234::INSTR",
            "usb::0X1ab1::0x0e11::dp8c1234::0::raw",
        ),
        ("ASRL/dev/ttyNONE0::INSTR", "asrl/dev/ttyNONE0", "/dev/ttyNONE0"),
    ],
)
def test_one_place_on_the_network_is_one_line(same):
    assert len({frozenset(line_keys(url)) for url in same}) == 1


def test_a_socket_of_scpi_is_the_instrument_itself():
    named = ("tcp://10.0.0.5:5025", "TCPIP0::10.0.0.5::5025::SOCKET", "TCPIP::10.0.0.5::INSTR")
    assert all(line_keys(a) & line_keys(b) for a in named for b in named)
    assert not line_keys("tcp://10.0.0.5:5026") & line_keys("TCPIP::10.0.0.5::INSTR")


def test_a_name_of_ni_is_one_device_in_every_folder(tmp_path, monkeypatch):
    before = line_keys("Dev1", "ni_output")
    monkeypatch.chdir(tmp_path)
    assert before == line_keys("dev1", "ni_position") != line_keys("Dev2", "ni_output")


def test_two_rigs_at_one_instrument_exclude_each_other_however_it_is_written(tmp_path):
    first = rig(tmp_path, "first", ("GPIB0::24::INSTR", "GPIB0::25::INSTR"))
    second = rig(tmp_path, "second", ("gpib::24", "GPIB0::26::INSTR"), wire="B")
    with (
        rig_locks(first, "A7"),
        pytest.raises(InUse, match=r"^The line gpib::24 is in use"),
        rig_locks(second, "B"),
    ):
        pytest.fail("two rigs at one instrument")


def test_this_computer_by_its_own_name_is_this_computer():
    assert line_keys(f"tcp://{socket.gethostname().upper()}:7") == line_keys("tcp://127.0.0.1:7")


def test_other_places_are_other_lines():
    urls = (
        "tcp://10.0.0.5",
        "tcp://10.0.0.5:503",
        "tcp://10.0.0.6",
        "tcp://gateway",
        "GPIB0::5",
        "GPIB1::5",
        "GPIB0::5::96",
        "TCPIP::10.0.0.5::INSTR",
        "TCPIP::10.0.0.5::inst1::INSTR",
        "TCPIP::10.0.0.5::gpib0,5::INSTR",
        "TCPIP::10.0.0.5::1234::SOCKET",
        "USB::1::2::A",
        "USB::1::2::B",
        "ASRL/dev/ttyNONE1::INSTR",
        "PXI0::15::INSTR",
        "GPIB0::" + "9" * 5000,
        "hwgrep://FTDI",
    )
    keys = [key for url in urls for key in line_keys(url)]
    assert len(set(keys)) == len(urls)
    assert line_keys("") == set()


@pytest.mark.skipif(os.name == "nt", reason="device files")
def test_a_serial_port_is_one_line_by_every_name(tmp_path):
    import pty

    host, device = pty.openpty()
    name = os.ttyname(device)
    by_id, other = tmp_path / "by-id", tmp_path / "copy"
    by_id.symlink_to(name)
    other.symlink_to(by_id)
    try:
        keys = [line_keys(str(path)) for path in (name, by_id, other, f"spy://{name}?file=x")]
        assert all(a & b for a in keys for b in keys)
        assert any("device" in key for key in keys[0])
        second = pty.openpty()
        assert not line_keys(os.ttyname(second[1])) & keys[0]
        os.close(second[0])
        os.close(second[1])
    finally:
        os.close(host)
        os.close(device)
    assert line_keys(str(by_id)) & keys[1], "the link's own name stays when the port is gone"


@pytest.mark.skipif(os.name == "nt" or os.getuid() != 0, reason="makes a device file (root)")
def test_another_node_of_the_same_device_is_the_same_line(tmp_path):
    try:
        os.mknod(tmp_path / "ttyX", 0o600 | 0o020000, os.makedev(188, 0))
        os.mknod(tmp_path / "ttyY", 0o600 | 0o020000, os.makedev(188, 0))
    except OSError:
        pytest.skip("this system makes no device files")
    assert line_keys(str(tmp_path / "ttyX")) & line_keys(str(tmp_path / "ttyY")) == {"line device 188:0"}


def test_a_bench_in_use_is_exit_status_5_with_its_holder(tmp_path, capsys):
    """The second command names another wire and another spelling of the address."""
    with started() as urls, ExitStack() as open_:
        first = rig_file(tmp_path / "first.toml", urls)
        host = urls["amplifier"].replace("127.0.0.1", "localhost")
        second = rig_file(tmp_path / "second.toml", {**urls, "amplifier": host}, wire="other")
        session = open_.enter_context(Session(str(first)))
        words = ["run", "validation", "--rig", str(second), "-o", str(tmp_path / "b.run.sqlite"), "--json"]
        assert cli(words) == 5
        told = json.loads(capsys.readouterr().out)
        assert told["exit_status"] == 5
        lines = [
            f"The line {url} is in use by process {os.getpid()} since " for url in (host, urls["encoder_daq"])
        ]
        assert any(told["error"].startswith(line) for line in lines)
        assert not (tmp_path / "b.run.sqlite").exists()
        assert cli(["check", str(second), "--yes"]) == 5
        session.run("validation", {"points": "2"}, tmp_path / "a.run.sqlite")
        open_.close()
        assert cli([*words, "--set", "points=2"]) == 0


# --- run files -------------------------------------------------------------------------------------------


@pytest.mark.long("takes three seconds")
def test_a_run_being_recorded_is_neither_resumed_nor_replaced(tmp_path, capsys):
    """The file is that of a killed run until its recorder closes it, so only the lock shows that one records it."""
    out, refused = tmp_path / "a.run.sqlite", []
    words = ("--rig", "one_wire_twin", "-o", str(out), "--quiet")

    def at_50(sample, _step, _input_K):
        if sample.tick == 50:
            run = ["run", "validation", *words]
            for command in (["resume", str(out)], [*run, "--force"], run):
                program = [sys.executable, "-m", "smarig", *command]
                refused.append(subprocess.run(program, capture_output=True, text=True, check=False))

    with Session("one_wire_twin") as session:
        session.run("validation", {"points": "2"}, out, listeners=[CallbackListener(on_sample=at_50)])
    assert [done.returncode for done in refused] == [5, 5, 5], [done.stderr for done in refused]
    for done in refused:
        assert done.stderr.startswith(f"smarig: Run {out} is being recorded by process {os.getpid()} since ")
        assert done.stderr.count("\n") == 1
    assert load_run(out).cause == "done"


def test_a_run_is_resumed_once_at_a_time_within_a_process_too(tmp_path):
    with Session("one_wire_twin") as session:
        whole = session.run("validation", {"points": "2"}, tmp_path / "whole.run.sqlite")
    path = cut(whole, tmp_path / "killed.run.sqlite", 700)
    from smarig.record import recording

    with recording(path), pytest.raises(InUse, match=r"killed\.run\.sqlite is being recorded by process"):
        resume(path)
    assert load_run(path).cause.startswith("incomplete")
    assert resume(path).cause == "done"


def test_run_files_leave_no_locks(tmp_path, lock_folder):
    with Session("one_wire_twin") as session:
        session.run("validation", {"points": "2"}, tmp_path / "a.run.sqlite")
    assert not list(lock_folder.iterdir())


def test_an_address_that_can_be_none_has_a_key_of_its_own():
    assert line_keys("tcp://a\0b:5") == {"line a\0b:5"}
