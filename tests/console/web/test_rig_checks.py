"""Rigs in the console: rig files of the folder, bring-up of real benches only on request, and its emergency stop."""

import os
import re
import signal
import subprocess
import time
from pathlib import Path
from urllib.parse import urlencode

import pytest

from console.web.started_console import Console, started_console
from smarig.console.web.rig_checks import RigChecks
from smarig.console.web.rig_files import rig_entry, rig_names, rigs_of
from smarig.core import UsageError

REAL = """
name = "real"
base = "bench_one_wire"
[links.amplifier]
url = "/dev/absent-amplifier"
[links.encoder_daq]
url = "/dev/absent-encoder"
"""
FORM = {"Content-Type": "application/x-www-form-urlencoded"}


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    found = tmp_path_factory.mktemp("rigs")
    (found / "real.toml").write_text(REAL)
    (found / "campaign.toml").write_text('[[step]]\nprotocol = "validation"\n')
    (found / "broken.toml").write_text('base = "one_wire_twin"\nname = "broken"\nperiod_s = -1\n')
    (found / "no.toml").write_bytes(b"\xff\x00" * 100)
    return found


@pytest.fixture(scope="module")
def console(folder):
    with started_console(folder) as found:
        yield found


def wait_for_end(checks, rig):
    end_s = time.monotonic() + 60
    while checks.of(rig).passed is None:
        assert time.monotonic() < end_s
        time.sleep(0.02)
    return checks.of(rig)


def test_rig_files_of_the_folder_come_first(folder):
    assert rig_names(folder)[:2] == ["broken.toml", "real.toml"]
    broken, real = rigs_of(folder)[:2]
    assert "period_s" in broken.problems[0]
    assert broken.file is None
    assert not real.problems
    assert real.is_real
    assert rig_entry("bench_one_wire", folder).is_template
    assert not rig_entry("one_wire_serial", folder).is_real


@pytest.mark.parametrize(
    "content",
    [
        b'name = "mine\nbase = "one_wire_twin"\n',
        b'base = "one_wire_twin"\nname = "mine\n',
        b"[links.amplifier\n",
        b'actuator = "gorbet_one_wire"\nname = "W\xe4rme"\n',
        b'base = "one_wire_twin"\nbase = "one_wire_twin"\n',
    ],
)
def test_a_rig_file_that_is_not_valid_toml_is_listed_with_its_error(tmp_path, content):
    (tmp_path / "mine.toml").write_bytes(content)
    (tmp_path / "campaign.toml").write_text('[[step]]\nprotocol = "validation\n')
    first, second = rigs_of(tmp_path)[:2]
    assert (first.name, first.file) == ("mine.toml", None)
    assert "mine.toml is not valid TOML: " in first.problems[0]
    assert not second.name.endswith(".toml"), "nothing says that the other file is a rig"


def test_a_rig_file_that_is_not_valid_toml_is_shown_but_not_started(console: Console, folder):
    (folder / "quote.toml").write_text('base = "one_wire_serial"\nname = "quote\n')
    assert re.search(
        r"quote\.toml</a>.*Not ready: [^<]*quote\.toml is not valid TOML", console.ask("/rigs").body
    )
    page = console.ask("/rigs/rig?rig=quote.toml").body
    assert "is not valid TOML" in page
    assert 'action="/rigs/check"' not in page
    assert "New run on this rig" not in page
    reply = console.ask("/rigs/check", "POST", console.own | FORM, urlencode({"rig": "quote.toml"}))
    assert reply.status == 422
    (folder / "quote.toml").unlink()


def test_a_file_that_cannot_be_read_hides_no_other_rig(tmp_path):
    """Pipes, devices, wrong actuators and absurd names: a row each or none, and the list is there."""
    os.mkfifo(tmp_path / "pipe.toml")
    (tmp_path / "zero.toml").symlink_to("/dev/zero")
    (tmp_path / "folder.toml").mkdir()
    (tmp_path / "typo.toml").write_text('base = "one_wire_serial"\nname = "mine"\nactuator = "nitinoll"\n')
    (tmp_path / "long.toml").write_text(f'base = "{"a" * 5000}"\n')
    (tmp_path / "nul.toml").write_text('base = "one_wire_twin"\nname = "n"\n[load]\nfile = "a\\u0000.toml"\n')
    (tmp_path / "dots.toml").write_text("a" + ".a" * 40_000 + " = 1\n")
    Path(os.fsdecode(os.fsencode(tmp_path) + b"/bad\xff.toml")).write_text(
        'base = "one_wire_twin"\nname = "b"\n'
    )
    rigs = {rig.name: rig for rig in rigs_of(tmp_path)}
    assert {name for name in rigs if name.endswith(".toml")} == {"typo.toml", "long.toml", "nul.toml"}
    assert all(rigs[name].problems for name in ("typo.toml", "long.toml", "nul.toml"))
    assert "nitinoll" in rigs["typo.toml"].problems[0]
    assert not rigs["one_wire_serial"].problems


def test_the_list_runs_no_driver(tmp_path):
    (tmp_path / "driver.py").write_text(f"open({str(tmp_path / 'was_here')!r}, 'w')\n")
    link = '[links.encoder_daq]\ndriver = "./driver.py"\n'
    (tmp_path / "own.toml").write_text(f'name = "own"\nbase = "one_wire_serial"\n{link}')
    assert rigs_of(tmp_path)[0].name == "own.toml"
    assert not (tmp_path / "was_here").exists()


def test_a_check_is_shown_at_the_place_of_its_rig(console: Console, folder):
    (folder / "a&b=%41+c.toml").write_text(REAL)
    reply = console.ask(
        "/rigs/check", "POST", console.own | FORM, urlencode({"rig": "a&b=%41+c.toml", "heat": "yes"})
    )
    assert "a&amp;b=%41+c.toml</h1>" in console.ask(reply.headers["location"]).body
    (folder / "a&b=%41+c.toml").unlink()


def test_a_check_that_is_killed_says_to_look_at_the_rig(folder):
    checks = RigChecks(folder)
    checks.start("one_wire_serial")
    checks._processes["one_wire_serial"].kill()
    assert "Make sure that no current flows" in wait_for_end(checks, "one_wire_serial").sentence


def test_a_real_wire_is_not_heated_without_the_tick(console: Console):
    for more in ({}, {"heat": "no"}):
        reply = console.ask("/rigs/check", "POST", console.own | FORM, urlencode({"rig": "real.toml"} | more))
        assert reply.status == 422
        assert "Tick the box if you are beside the rig" in reply.body


@pytest.mark.parametrize("rig", ["one_wire_twin", "bench_one_wire", "broken.toml", "absent", "", "<b>"])
def test_what_cannot_be_brought_up_is_refused_in_a_sentence(console: Console, rig):
    reply = console.ask("/rigs/check", "POST", console.own | FORM, urlencode({"rig": rig}))
    assert reply.status == 422
    assert 'class="notice bad"' in reply.body or "<p" in reply.body
    assert "<b>" not in reply.body


@pytest.mark.long("takes a second")
def test_devices_that_are_not_there_fail_the_check_with_the_sentence_of_the_command(folder):
    checks = RigChecks(folder)
    checks.start("real.toml")
    found = wait_for_end(checks, "real.toml")
    assert found.passed is False
    assert "absent-amplifier" in found.sentence
    checks.close()


def test_a_check_is_not_started_twice_and_stops_when_asked(folder):
    checks = RigChecks(folder)
    checks.start("one_wire_serial")
    with pytest.raises(UsageError, match="one_wire_serial is being checked already"):
        checks.start("one_wire_serial")
    assert checks.terminate() == ["one_wire_serial"]
    found = wait_for_end(checks, "one_wire_serial")
    assert found.passed is False
    assert checks.terminate() == []
    checks.close()


def test_stop_everything_stops_a_check(console: Console):
    console.ask("/rigs/check", "POST", console.own | FORM, urlencode({"rig": "two_wire_serial"}))
    reply = console.ask("/stop-all", "POST", console.own)
    assert "two_wire_serial" in reply.headers["location"]


def test_the_end_interrupts_a_check_instead_of_waiting_for_it(folder):
    checks = RigChecks(folder)
    checks.start("one_wire_serial")
    checks.close()
    assert wait_for_end(checks, "one_wire_serial").passed is False


@pytest.mark.long("takes three seconds")
def test_the_end_of_a_console_ends_its_checks(tmp_path):
    (tmp_path / "own.toml").write_text('name = "own"\nbase = "one_wire_serial"\nwire = "own"\n')
    with started_console(tmp_path) as console:
        console.ask("/rigs/check", "POST", console.own | FORM, urlencode({"rig": "own.toml"}))
        assert f"check {tmp_path / 'own.toml'} --yes" in processes()
        console.process.terminate()
        console.process.wait(30)
        assert f"check {tmp_path / 'own.toml'} --yes" not in processes()


def processes():
    """The command lines of all processes: also of other tests, so a rig of its own is looked for."""
    return subprocess.run(["ps", "-eo", "args", "-ww"], capture_output=True, text=True, check=True).stdout


def test_an_address_with_a_null_character_is_refused_in_a_sentence(console: Console):
    reply = console.ask("/library/run?file=%00")
    assert (reply.status, reply.body[:38]) == (400, "The address holds a null character, or")


@pytest.mark.long("one of each kind", one_of_each=True)
@pytest.mark.parametrize("length", [300, 5000])
@pytest.mark.parametrize(
    ("form", "kind"),
    [
        ("experiment=validation&rig={}", "rig"),
        ("rig=one_wire_twin&experiment={}", "protocol"),
        ("rig=one_wire_twin&experiment=campaign:{}", "campaign"),
    ],
)
def test_a_name_too_long_for_a_file_is_unknown_by_its_beginning(console: Console, form, kind, length):
    wanted, headers = form.format("a" * length), {"Content-Type": "application/x-www-form-urlencoded"}
    replies = [
        console.ask(f"/new?{wanted}"),
        console.ask("/new", "POST", console.own | headers, f"{wanted}&do=preview"),
        console.ask("/new", "POST", console.own | headers, f"{wanted}&out=a.run.sqlite"),
    ]
    for reply in replies:
        assert reply.status == 422
        assert re.search(rf"(No {kind} )?&#39;a{{30,40}} … a{{30,40}}&#39;( is no {kind})?\.", reply.body)


def test_only_words_of_the_queue_change_it(console: Console):
    assert console.ask("/queue/zzz", "POST", console.own).status == 422


def stopped_check(folder):
    """A check that does not react, and its process."""
    checks = RigChecks(folder)
    checks.start("one_wire_serial")
    process = checks._processes["one_wire_serial"]
    process.send_signal(signal.SIGSTOP)
    os.waitid(os.P_PID, process.pid, os.WSTOPPED | os.WNOWAIT)  # of two pending signals the lower comes first
    return checks, process


def test_a_check_that_does_not_react_is_killed_at_the_end_and_that_is_said(folder, capsys, monkeypatch):
    monkeypatch.setattr("smarig.console.web.rig_checks._WAIT_S", 0.2)
    checks, _ = stopped_check(folder)
    checks.close()
    assert "The check of one_wire_serial did not end and was killed." in capsys.readouterr().err
    assert "no current flows" in wait_for_end(checks, "one_wire_serial").sentence


def test_a_check_that_takes_too_long_and_does_not_react_is_killed_and_says_to_look(folder, monkeypatch):
    monkeypatch.setattr("smarig.console.web.rig_checks._WAIT_S", 0.2)
    monkeypatch.setattr("smarig.console.web.rig_checks.LONGEST_S", 0.2)
    checks = RigChecks(folder)
    checks.start("one_wire_serial")
    checks._processes["one_wire_serial"].send_signal(signal.SIGSTOP)
    assert "Make sure that no current flows" in wait_for_end(checks, "one_wire_serial").sentence


def test_a_check_that_ignores_a_stop_is_killed_and_that_is_said(folder, monkeypatch):
    monkeypatch.setattr("smarig.console.web.rig_checks._WAIT_S", 0.2)
    checks, process = stopped_check(folder)
    assert checks.terminate(but=[process.pid]) == []  # its name was told before
    assert "no current flows" in wait_for_end(checks, "one_wire_serial").sentence


def test_a_driver_of_ones_own_is_not_run_by_the_pages(tmp_path):
    (tmp_path / "blocks.py").write_text("import time\ntime.sleep(1e6)\n")
    text = (
        'name = "own"\nbase = "laboratory_supply"\nwire = "w"\n'
        f'[links.amplifier]\ndriver = "{tmp_path / "blocks.py"}"\n'
    )
    (tmp_path / "own.toml").write_text(text)
    entry = rig_entry("own.toml", tmp_path)
    assert (entry.has_own_driver, entry.problems) == (True, ())
    with started_console(tmp_path) as console:
        page = console.ask("/rigs/rig?rig=own.toml").body
        assert "Its own driver is run by a check only" in page
