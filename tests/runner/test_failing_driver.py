"""A driver of one's own that ends the program, returns what is no reading, or leaves a thread: current and words."""

import os
import re
import signal
import subprocess
import sys
import time

import pytest

from smarig.cli import run as cli
from smarig.core.catalogue import own_files

DRIVER = '''"""An instrument on a twin at the pace of the host; what it does at a second is in EVENTS."""
import _thread, asyncio, os, signal, threading, time
from smarig.device import Electrical
from smarig.rig import Twin

SPEED = 50.0

class Instrument:
    identity, unit, absolute, has_lease, tripped = "BOX", "mm", True, False, ""
    events, at_s = {}, 15.0
    flows_A = 0.0
    lines = []

    def __init__(self):
        self.twin, self.began_s = Twin.named("one_wire_twin"), time.monotonic()
        self.sample = self.twin.step(0.0)[-1]

    def now(self, event):
        until = (time.monotonic() - self.began_s) * SPEED
        while self.sample.t_s < until:
            self.sample = self.twin.step(self.flows_A)[-1]
        if event in self.events and until > self.at_s:
            return eval(self.events[event], globals() | {"box": self})
        return None

    def arm(self):
        self.flows_A = 0.0

    def set_current(self, current_A):
        self.now("set")
        self.flows_A = current_A

    def measure(self):
        return self.now("measure") or Electrical(self.sample.current_A, self.sample.voltage_V)

    def position(self):
        return self.now("position") or self.sample.position

    def off(self):
        answer = self.now("off")
        self.flows_A = 0.0
        return answer or ""

    def close(self):
        pass

def raised(error):
    raise error

box = None

def failing(where, rig):
    global box
    box = box or Instrument()
    Instrument.events = EVENTS
    return box
'''
RIG = """
name = "failing"
base = "bench_one_wire"
wire = "failing"
period_s = 0.5
encoder.resolution = 0.002
[links.amplifier]
driver = "./failing.py"
url = "tcp://localhost:1"
framing = "lines"
[links.encoder_daq]
driver = "./failing.py"
url = "tcp://localhost:1"
framing = "lines"
[simulator]
devices = "text"
start = false
speed = 50.0
"""
WAVE = "--set low_A=0 --set high_A=0.9 --set loops=1 --set loop_s=60"
RUN = f"run minor_loops --rig ./failing.toml {WAVE} --quiet -o r.run.sqlite"


@pytest.fixture
def run(tmp_path, monkeypatch, capsys):
    """Runs it with what happens in its methods; returns exit status and what was printed."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr("smarig.rig.shutdown.OFF_S", 0.0)
    monkeypatch.setattr("smarig.rig.shutdown.OFF_ATTEMPTS", 1)
    (tmp_path / "failing.toml").write_text(RIG)

    def begin(**events):
        (tmp_path / "failing.py").write_text(DRIVER + f"\nEVENTS = {events!r}\n")
        with own_files():
            status = cli(RUN.split())
        return status, capsys.readouterr().err

    return begin


@pytest.mark.parametrize(
    ("where", "error"),
    [
        ("measure", "SystemExit(0)"),
        ("set", "SystemExit(0)"),
        ("position", "SystemExit(0)"),
        ("measure", "asyncio.CancelledError()"),
        ("measure", "GeneratorExit()"),
    ],
)
def test_what_would_end_the_program_ends_the_run_with_a_sentence(run, where, error):
    status, err = run(**{where: f"raised({error})"})
    assert status == 3
    assert re.search(r"failing\.py, line \d+: " + error.split("(")[0].split(".")[-1], err)
    assert "The current is at zero." in err


@pytest.mark.parametrize("error", ["SystemExit(0)", "KeyboardInterrupt()", "asyncio.CancelledError()"])
def test_an_order_of_zero_that_fails_is_said_and_not_taken_for_zero(run, error):
    status, err = run(measure="os.kill(os.getpid(), signal.SIGTERM)", off=f"raised({error})")
    assert status == 3
    assert "did not confirm that it is off: switch it off by hand now" in err
    assert "is at zero" not in err


@pytest.mark.parametrize(
    ("where", "value", "shown"),
    [
        ("measure", "'0.5'", "measure returned '0.5', which is not an Electrical"),
        ("measure", "Electrical(0.5 + 0j, 1.0)", "measure returned (0.5+0j), which is not a number"),
        ("measure", "Electrical(10**400, 1.0)", "measure returned a value of type int|measure returned 1000"),
        ("position", "'3.5 mm'", "position returned '3.5 mm', which is not a number"),
        ("position", "__import__('numpy').array([3.5])", r"position returned array\(\[3.5\]\)"),
    ],
)
def test_what_is_no_reading_is_said_to_be_one_of_the_driver(run, where, value, shown):
    status, err = run(**{where: value})
    assert status == 3
    assert re.search(shown if "|" in shown or "\\" in shown else re.escape(shown), err)
    assert "Correct the driver" in err


def test_an_answer_of_off_that_is_no_text_confirms_nothing(run):
    status, err = run(measure="os.kill(os.getpid(), signal.SIGTERM)", off="True")
    assert status == 3
    assert "off returned True, which is not a text" in err


def test_an_error_that_cannot_be_shown_is_named_by_its_class(run):
    error = "type('Odd', (Exception,), {'__str__': lambda self: 1 / 0})()"
    status, err = run(measure=f"raised({error})")
    assert status == 3
    assert ": Odd. The current is at zero." in err


def test_a_factory_that_ends_the_program_is_no_driver_that_passes(run, tmp_path, capsys):
    (tmp_path / "failing.py").write_text("def failing(where, rig):\n    raise SystemExit(0)\n")
    with own_files():
        status = cli(["check", "./failing.toml", "--driver", "./failing.py", "--yes"])
    assert status == 2
    assert "failing.py, line 2: SystemExit: 0." in capsys.readouterr().err


@pytest.fixture
def start(tmp_path):
    """Starts the run in a process of its own."""
    started = []

    def begin(**events):
        (tmp_path / "failing.toml").write_text(RIG)
        (tmp_path / "failing.py").write_text(DRIVER + f"\nEVENTS = {events!r}\n")
        started.append(_process(tmp_path))
        return started[-1]

    yield begin
    for process in started:
        process.kill()
        process.communicate()


def _process(tmp_path):
    return subprocess.Popen(
        [sys.executable, "-m", "smarig", *RUN.split()],
        cwd=tmp_path,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.default_int_handler),
    )


@pytest.mark.skipif(os.name == "nt", reason="signals of POSIX")
def test_a_thread_that_a_driver_left_does_not_hold_the_process(start):
    thread = "threading.Thread(target=time.sleep, args=(300.0,)).start()"
    started = start(position=f"[{thread}, '3.5 mm'][1]")
    _, err = started.communicate(timeout=90)
    assert started.returncode == 3, err
    assert "position returned '3.5 mm'" in err


@pytest.mark.skipif(os.name == "nt", reason="signals of POSIX")
def test_two_ctrl_c_end_it_although_a_library_took_the_signals(start, tmp_path):
    """An event loop that was closed leaves no descriptor for signals; then the driver does not come back."""
    taken = (
        "[(loop := asyncio.new_event_loop()).add_signal_handler(10, print), loop.close(), time.sleep(300.0)]"
    )
    started = start(measure=taken, position="open('reached', 'w').close()")
    end_s = time.monotonic() + 60
    while not (tmp_path / "reached").exists() and time.monotonic() < end_s:
        time.sleep(0.1)
    time.sleep(1.0)
    for _ in range(2):
        started.send_signal(signal.SIGINT)
        time.sleep(1.0)
    _, err = started.communicate(timeout=30)
    assert started.returncode == 130
    assert "Ctrl-C was pressed twice" in err
