"""A folder of somebody else in the console: its queue waits, is shown with what it would do, and starts on a click."""

import html
import re
from pathlib import Path
from urllib.parse import urlencode

import pytest

from console.queue.entries import opened, request
from console.web.started_console import started_console
from running.started_run import waited

FORM = {"Content-Type": "application/x-www-form-urlencoded"}


@pytest.fixture
def gift(tmp_path, monkeypatch):
    """A folder that somebody else has filled."""
    for name in ("RUNNING", "LOCK", "HISTORY"):
        monkeypatch.setenv(f"SMARIG_{name}_DIR", str(tmp_path / name.lower()))
    folder = tmp_path / "gift"
    folder.mkdir()
    (folder / "evil.py").write_text(f"open({str(tmp_path / 'executed')!r}, 'w')\n")
    link = '[links.amplifier]\ndriver = "./evil.py"\n'
    (folder / "own.toml").write_text(f'name = "own"\nbase = "one_wire_serial"\nwire = "own"\n{link}')
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("SMARIG_STATE_DIR", str(tmp_path / "state of somebody else"))
        with opened(folder) as queue:
            queue.add(request("plain"))
            queue.add(request("own", experiment="./evil.py", settings={}))
    return folder


def values(page: str) -> list[str]:
    return [html.unescape(value) for value in re.findall(r'name="entry" value="([^"]+)"', page)]


def test_a_queue_that_came_with_a_folder_waits_and_starts_what_is_clicked(gift, tmp_path):
    executed: Path = tmp_path / "executed"
    with started_console(gift) as console:
        page = console.ask("/").body
        assert "2 entries have not been started by you" in page
        assert "smarig run ./evil.py --rig one_wire_twin" in page
        assert "Runs code that is not of smarig: <b>protocol evil.py</b>" in page
        assert "Start entry 1 without own code" in page
        sent, plain = console.own | FORM, next(value for value in values(page) if value.startswith("1 "))
        for wrong in ("1 x", plain.replace("1 ", "2 "), "x", "9" * 30 + " x", ""):
            assert console.ask("/queue/start", "POST", sent, urlencode({"entry": wrong})).status == 422
        assert console.ask("/queue/start", "POST", sent, urlencode({"entry": plain})).status == 303
        waited(lambda: "done" in console.ask("/overview/parts").body, "the end of the entry that was started")
        assert (gift / "plain.run.sqlite").exists()
        assert not executed.exists()
        own = next(value for value in values(console.ask("/").body) if value.startswith("2 "))
        assert console.ask("/queue/start", "POST", sent, urlencode({"entry": own})).status == 303
        waited(executed.exists, "the own code that a click has allowed")


def test_pages_of_a_rig_with_own_code_run_nothing_before_a_click_that_shows_it(gift, tmp_path):
    with started_console(gift) as console:
        sent = console.own | FORM
        for place in ("/rigs", "/rigs/rig?rig=own.toml", "/new?rig=own.toml&experiment=validation"):
            assert console.ask(place).status == 200
        check = console.ask("/rigs/check", "POST", sent, urlencode({"rig": "own.toml"}))
        assert check.status == 422
        assert "would run driver of the amplifier evil.py" in check.body
        fields = {"rig": "own.toml", "experiment": "validation", "set.points": "3", "out": "a.run.sqlite"}
        for do in ("preview", "add"):
            reply = console.ask("/new", "POST", sent, urlencode({**fields, "do": do}))
            assert reply.status == 422
            assert (
                "This runs driver of the amplifier evil.py. Press the button again to allow it." in reply.body
            )
        assert not (tmp_path / "executed").exists()
        digest = re.search(r'name="code" value="([^"]+)"', console.ask("/rigs/rig?rig=own.toml").body)[1]
        console.ask("/rigs/check", "POST", sent, urlencode({"rig": "own.toml", "code": digest}))
        waited((tmp_path / "executed").exists, "the own code that a click has allowed")
