"""The line of progress: only at a terminal, with time left where a loop is counted, and gone before other output."""

import os
import pty
import re
import subprocess
import sys
import time

import pytest

from smarig.cli.working_line import WorkingLine
from smarig.core import counted, share_done


def test_the_time_left_follows_from_the_share_done():
    line = WorkingLine("report")
    began = time.monotonic()
    assert re.fullmatch(r"report: 5 s", line.text(began + 5))
    items = counted(range(10), 10)
    next(items)
    assert "0 of 10 done" in line.text(began + 5)
    next(items), next(items)
    assert line.text(began + 25).endswith("2 of 10 done, about 1:20 min left")
    items.close()
    assert share_done() == (0, 0)


def test_loops_inside_a_counted_loop_do_not_count():
    seen = []
    for _ in counted("ab", 2):
        for _ in counted("xyz", 3):
            seen.append(share_done())
    assert set(seen) == {(0, 2), (1, 2)}
    assert share_done() == (0, 0)


def test_a_loop_that_is_left_ends_the_count():
    loop = counted("ab", 2)
    next(loop)
    loop.close()  # as Python does when an error leaves the loop
    assert share_done() == (0, 0)


_SLOW = """
import sys, time
import importlib
w = importlib.import_module("smarig.cli.working_line")
w.APPEARS_S = 0.2
from smarig.cli.output import show_message
with w.working_line("identify"):
    time.sleep(1.2)
    show_message("Warning: one.")
"""


def shown_at_a_terminal(script, term):
    """What a script writes to its stderr, a pseudo-terminal."""
    master, slave = pty.openpty()
    environment = {**os.environ, "TERM": term}
    running = subprocess.Popen([sys.executable, "-c", script], stderr=slave, env=environment)
    os.close(slave)
    text = b""
    while True:
        try:
            part = os.read(master, 4096)
        except OSError:
            break
        if not part:
            break
        text += part
    os.close(master)
    assert running.wait() == 0
    return text


@pytest.mark.long("takes three seconds")
@pytest.mark.skipif(os.name == "nt", reason="needs a pseudo-terminal")
def test_the_line_is_removed_before_other_output():
    text = shown_at_a_terminal(_SLOW, "xterm")
    assert b"identify: 1 s" in text
    assert re.search(rb"\r\x1b\[KWarning: one\.", text)


def test_nothing_is_written_into_a_pipe():
    done = subprocess.run([sys.executable, "-c", _SLOW], capture_output=True, check=True)
    assert done.stderr == b"Warning: one.\n"


_ASKED = """
import importlib, time
w = importlib.import_module("smarig.cli.working_line")
w.APPEARS_S = 0.2
with w.working_line("study"):
    time.sleep(0.9)
    with w.without_line():
        print("Which column?", file=__import__("sys").stderr, flush=True)
        time.sleep(1.5)
        print("answered", file=__import__("sys").stderr, flush=True)
"""


@pytest.mark.skipif(os.name == "nt", reason="needs a pseudo-terminal")
@pytest.mark.parametrize(
    "term", ["xterm", pytest.param("dumb", marks=pytest.mark.long("takes three seconds"))]
)
def test_a_question_is_left_alone_and_a_dumb_terminal_gets_no_line(term):
    text = shown_at_a_terminal(_ASKED, term)
    between = text.split(b"Which column?")[1].split(b"answered")[0]
    assert between.strip() == b""
    assert (b"study: 1 s" in text) == (term == "xterm")


_OFTEN = """
import importlib, time
w = importlib.import_module("smarig.cli.working_line")
w.APPEARS_S, w._EVERY_S = 0.0, 0.0005
from smarig.cli.output import show_message
with w.working_line("identify"):
    for k in range(300):
        time.sleep(0.001)
        show_message(f"message {k}.")
"""


def test_no_message_is_printed_behind_the_line():
    """The line is rewritten all the time; each message begins its own row."""
    text = shown_at_a_terminal(_OFTEN, "xterm")
    assert text.count(b"identify: ") > 20
    assert len(re.findall(rb"(?:(?<=\x1b\[K)|(?<=\n)|^)message \d+\.\r\n", text)) == 300


@pytest.mark.long("takes three seconds")
def test_a_closed_stderr_changes_nothing():
    done = subprocess.run(
        [sys.executable, "-m", "smarig", "report", "nope.sqlite"], stderr=None, capture_output=False,
        preexec_fn=lambda: os.close(2), stdout=subprocess.DEVNULL,
    )  # fmt: skip
    assert done.returncode == 2
