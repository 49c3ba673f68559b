"""Rig files that lie in the folder of a console and lead out of it: nothing is opened or looked at before a click."""

import asyncio
import html
import re
from collections.abc import Iterator
from contextlib import ExitStack, closing, contextmanager
from pathlib import Path
from urllib.parse import quote, urlencode

import pytest

from console.web.started_console import Reply
from gate.canaries import Canaries
from gate.watch import looks_seen, watched
from smarig.config import load_rig
from smarig.console import Library
from smarig.console.queue.queue import Queue
from smarig.console.web.application import console_application
from smarig.console.web.console_context import ConsoleContext
from smarig.console.web.console_scope import ConsoleScope
from smarig.console.web.ended_runs import EndedRuns
from smarig.console.web.library_scanner import LibraryScanner
from smarig.console.web.rig_checks import RigChecks
from smarig.console.web.rig_files import rig_entry, rig_names
from smarig.console.web.viewers import Viewers
from smarig.core import NotPassed, place_inside, shipped

KEYS = ("base", "actuator", "load.file", "links.DEVICE.driver")
KEYS += ("simulator.library", "simulator.faults", "simulator.trace")
CLOSED = "which lies outside of the folder and is opened only after a click on the rig's page."
PORT = 1


class Pages:
    """The pages of a console in this process, where what they do is watched."""

    def __init__(self, context: ConsoleContext) -> None:
        self.library = context.library
        self._application = console_application(context, "token", PORT)

    def ask(self, path: str, **form: str) -> Reply:
        """A page, or what a form of it sends."""
        return self.send(path, urlencode(form).encode())

    def send(self, path: str, body: bytes, kind: str = "application/x-www-form-urlencoded") -> Reply:
        """What the page answers to a body of this kind, or without one."""
        return asyncio.run(self._ask(path, body, kind))

    async def _ask(self, path: str, body: bytes, kind: str) -> Reply:
        place, _, query = path.partition("?")
        headers = {"host": f"127.0.0.1:{PORT}", "cookie": f"smarig-console-{PORT}=token"}
        headers |= {"origin": f"http://127.0.0.1:{PORT}", "content-type": kind}
        headers |= {"content-length": str(len(body))}
        scope = {
            "type": "http",
            "method": "POST" if body else "GET",
            "path": place,
            "raw_path": place.encode(),
            "query_string": query.encode(),
            "headers": [(k.encode(), v.encode()) for k, v in headers.items()],
        }
        sent = []

        async def receive():
            return {"type": "http.request", "body": body, "more_body": False}

        async def send(message):
            sent.append(message)

        await self._application(scope, receive, send)
        text = b"".join(message.get("body", b"") for message in sent).decode()
        names = {k.decode(): v.decode() for k, v in sent[0]["headers"]}
        return Reply(sent[0]["status"], names, html.unescape(text))


@contextmanager
def pages_of(folder: Path) -> Iterator[Pages]:
    """Those of the console of a folder."""
    with ExitStack() as stack:
        library, queue = Library.open(folder), stack.enter_context(Queue.open(folder))
        scanner, scope = LibraryScanner(library), ConsoleScope(folder)
        viewers, checks = (
            stack.enter_context(closing(Viewers())),
            stack.enter_context(closing(RigChecks(folder))),
        )
        yield Pages(
            ConsoleContext(
                folder, "one_wire_twin", queue, library, scanner, scope, EndedRuns(scope), viewers, checks
            )
        )


@pytest.fixture
def outside(tmp_path) -> Canaries:
    """A folder beside that of the console, with a file for every key."""
    found = Canaries(tmp_path / "outside")
    found.folder.mkdir()
    for kind, name in (("rigs", "one_wire_twin"), ("actuators", "gorbet_one_wire")):
        target = "base.toml" if kind == "rigs" else "actuator.toml"
        (found.folder / target).write_bytes((shipped("configs") / kind / f"{name}.toml").read_bytes())
    (found.folder / "load.csv").write_text("time_s,force_N\n0,20\n100,20\n")
    for name in ("evil.py", "evil.so", "secret.toml", "victim.csv"):
        (found.folder / name).write_text("")
    return found


@pytest.fixture
def folder(tmp_path, outside) -> Path:
    """A folder with a rig file for every key and every way out."""
    found = tmp_path / "folder"
    found.mkdir()
    (found / "link").symlink_to(outside.folder)
    ways = {
        "absolute": outside.path(""),
        "parent": "../outside/",
        "deep": "link/../../outside/",
        "link": "link/",
    }
    for key in KEYS:
        for way, start in ways.items():
            text = outside.rig_texts()[f"rig: {key}"].replace(outside.path(""), start)
            (found / f"{key}_{way}.toml").write_text(text)
    return found


def own_rigs(folder: Path) -> list[str]:
    return [name for name in rig_names(folder) if name.endswith(".toml")]


def test_pages_open_nothing_outside_of_the_folder_that_a_rig_names(folder, outside):
    (folder / "linked.toml").symlink_to(outside.folder / "base.toml")
    with pages_of(folder) as pages:
        pages.ask("/rigs")  # what is imported is imported here
        with watched(outside.folder) as watch, looks_seen():
            listed = pages.ask("/rigs").body
            assert len(own_rigs(folder)) == len(KEYS) * 4
            assert listed.count(CLOSED) == len(KEYS) * 4
            for name in own_rigs(folder):
                page = pages.ask(f"/rigs/rig?rig={quote(name)}")
                assert page.status == 200
                assert page.body.count(CLOSED) == 1, name
                assert "Open what it names" in page.body
                assert "/rigs/check" not in page.body
                form = pages.ask(f"/new?rig={quote(name)}&experiment=validation")
                assert form.body.count(CLOSED) == 1, name
                assert 'class="primary" disabled' in form.body
                fields = {"rig": name, "experiment": "validation", "out": "a.run.sqlite", "code": ""}
                for refused in (
                    pages.ask("/rigs/check", rig=name, heat="yes"),
                    pages.ask("/new", do="preview", **fields),
                    pages.ask("/new", do="add", **fields),
                    pages.ask("/rigs/open", rig=name, mark="x"),
                ):
                    assert refused.status == 422, name
                    assert CLOSED in refused.body or "has changed since it was shown" in refused.body
            assert CLOSED in pages.ask(f"/rigs/rig?rig={quote(outside.path('base.toml'))}").body
    assert watch.seen == []


@pytest.mark.long("one of each kind", one_of_each=True)
@pytest.mark.parametrize("key", ["base", "actuator", "load.file"])
@pytest.mark.parametrize("way", ["absolute", "parent", "link"])
def test_what_a_click_has_opened_is_used(folder, outside, key, way):
    name = f"{key}_{way}.toml"
    with pages_of(folder) as pages:
        mark = re.search(r'name="mark" value="(\w+)"', pages.ask(f"/rigs/rig?rig={name}").body)[1]
        assert pages.ask("/rigs/open", rig=name, mark=mark).status == 303
        with watched(outside.folder) as watch:
            page = pages.ask(f"/rigs/rig?rig={name}").body
        assert watch.seen, "otherwise the watch would see nothing at all"
        assert CLOSED not in page
        assert "New run on this rig" in page
        assert "disabled" not in pages.ask(f"/new?rig={name}&experiment=validation").body
        assert pages.ask("/rigs").body.count(CLOSED) == len(KEYS) * 4 - 1, "each rig needs a click of its own"
        (folder / name).write_text((folder / name).read_text().replace("outside/", "outside/other_", 1))
        if way != "link":
            assert CLOSED in pages.ask(f"/rigs/rig?rig={name}").body, "another path needs another click"


def test_code_behind_a_base_is_shown_before_it_runs(folder, outside):
    link = '[links.amplifier]\ndriver = "./evil.py"\n'
    (outside.folder / "serial.toml").write_text(f'name = "s"\nbase = "one_wire_serial"\n{link}')
    (folder / "bench.toml").write_text('name = "bench"\nbase = "../outside/serial.toml"\n')
    with pages_of(folder) as pages:
        mark = re.search(r'name="mark" value="(\w+)"', pages.ask("/rigs/rig?rig=bench.toml").body)[1]
        pages.ask("/rigs/open", rig="bench.toml", mark=mark)
        refused = pages.ask("/rigs/check", rig="bench.toml")
        assert refused.status == 422
        assert f"would run driver of the amplifier {outside.path('evil.py')}" in refused.body
        assert outside.path("evil.py") in pages.ask("/rigs/rig?rig=bench.toml").body


def test_the_page_does_not_tell_whether_a_file_exists(folder, outside):
    texts = set()
    for name in ("actuator.toml", "notthere.toml"):
        rig = f'name = "r"\nbase = "one_wire_twin"\nactuator = "{outside.path(name)}"\n'
        (folder / "asks.toml").write_text(rig)
        entry = rig_entry("asks.toml", folder)
        texts.add(" ".join(entry.closed).replace(name, "FILE"))
        assert (entry.kind, entry.file.actuator) == ("Twin", outside.path(name))
    assert len(texts) == 1


def test_files_of_the_folder_need_no_click(folder):
    (folder / "sub").mkdir()
    (folder / "sub" / "load.csv").write_text("time_s,force_N\n0,20\n100,20\n")
    (folder / "sub" / "base.toml").write_text(
        'name = "b"\nbase = "one_wire_thermomechanical"\nload = {file = "load.csv"}\n'
    )
    (folder / "inner").symlink_to("sub/../sub")
    for base in ("sub/base.toml", "./inner/base.toml", f"{folder}/sub/base.toml", "sub/../sub/base.toml"):
        (folder / "own.toml").write_text(f'name = "own"\nbase = "{base}"\n')
        entry = rig_entry("own.toml", folder)
        assert (entry.closed, entry.problems) == ((), ()), base
        assert entry.file.load.file == str(folder / "sub" / "load.csv")
    (folder / "own.toml").write_text(
        'name = "own"\nbase = "one_wire_thermomechanical"\nload = {formula = "20+t"}\n'
    )
    assert rig_entry("own.toml", folder).closed == ()


def test_names_are_not_looked_for_in_the_present_folder(folder, outside, monkeypatch):
    monkeypatch.chdir(outside.folder)
    (outside.folder / "actuator").write_bytes((outside.folder / "actuator.toml").read_bytes())
    (folder / "here.toml").write_text('name = "r"\nbase = "one_wire_twin"\nactuator = "actuator"\n')
    (folder / "near.toml").write_text('name = "r"\nbase = "one_wire_twn"\n')
    assert "No actuator" in rig_entry("here.toml", folder).problems[0]
    assert "did you mean one_wire_twin?" in rig_entry("near.toml", folder).problems[0]
    with pytest.raises(NotPassed):
        load_rig(outside.path("base.toml"), folder)


def test_where_a_path_leads_in_a_folder(tmp_path):
    (tmp_path / "in").mkdir()
    folder = tmp_path / "in"
    links = {
        "out": "..",
        "round": "round",
        "up": "a/../../in/b",
        "self": str(folder / "b"),
        "far": "/",
        "two": "out/in",
    }
    for name, target in links.items():
        (folder / name).symlink_to(target)
    inner = {"a": "a", "./a/../b": "b", "self": "b", "self/c": "b/c", "": "", "nowhere/x": "nowhere/x"}
    for path, leads in inner.items():
        assert place_inside(folder / path, folder) == folder / leads, path
    for path in ("..", "a/../../in", "out", "out/in/a", "round", "up", "far", "two/a", "/etc", "../in2/a"):
        assert place_inside(folder / path, folder) is None, path
