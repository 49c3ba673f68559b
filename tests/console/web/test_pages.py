"""Pages of the console: hostile names are shown as text, hostile paths reach nothing, and runs do without it."""

import html
import os
import re
import shlex
import signal
import socket
import subprocess
import sys

import pytest

from console.web.started_console import Console, started_console
from running.started_run import found_run, started_run, waited
from smarig.console.web.console_scope import ConsoleScope
from smarig.console.web.ended_runs import EndedRuns
from smarig.record import stored_run
from smarig.runner import RunControl
from smarig.running import PanelRunInfo, RunStatus, announced, runs_in_progress

SLOW = ("run", "validation", "--rig", "one_wire_twin", "--speed", "2", "--set", "points=3")
HOSTILE = "<script>alert(1)</script>\"'javascript:\n&"


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    return tmp_path_factory.mktemp("console") / "runs"


@pytest.fixture(scope="module")
def console(folder):
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("SMARIG_RUNNING_DIR", str(folder.parent / "running"))
        with started_console(folder) as found:
            yield found


@pytest.fixture
def own_running_dir(tmp_path, monkeypatch):
    monkeypatch.setenv("SMARIG_RUNNING_DIR", str(tmp_path / "running"))


def test_hostile_names_of_a_run_are_shown_as_text(console: Console, folder):
    out = folder / '<img src=x>\udcff".run.sqlite'
    info = PanelRunInfo(
        HOSTILE, HOSTILE, HOSTILE + "\udc80", "twin", False, HOSTILE, 0.1, 5, 300.0, out, HOSTILE
    )
    control = RunControl()
    with announced(info, control, RunStatus(info, control)):
        (run,) = runs_in_progress()
        for path in ("/", "/overview/parts", f"/runs/{run.key}", f"/runs/{run.key}/phone"):
            reply = console.ask(path)
            assert reply.status == 200, path
            assert "<script>alert" not in reply.body
            assert "<img" not in reply.body
            assert "alert(1)" in reply.body.lower()


@pytest.mark.parametrize("text", [HOSTILE, "%F0%28", "x" * 20000])
def test_a_message_of_the_address_is_text(console: Console, text):
    from urllib.parse import quote

    reply = console.ask(f"/?message={quote(text)}&level={quote(HOSTILE)}")
    assert reply.status == 200
    assert "<script>alert" not in reply.body


@pytest.mark.parametrize(
    "path",
    [
        "/static/../context.py",
        "/static/%2e%2e/context.py",
        "/static/..%2fdesk.py",
        "/static/%2fetc/passwd",
        "/static/run.js%00",
        "/library/..%2f..%2fetc%2fpasswd/page",
        "/library/x%00/page",
        "/study/..",
        "/study/%2e%2e",
        "/study/000000000000",
        "/study/00000000000%0a",
        "/study/..%2f..%2fetc/alone",
        "/runs/..%2fx",
        "/runs/x%00/follow",
        "/library?offset=9999999999999999999999&since=99999-01-01&text=%22%00*",
        "/new?rig=%00&experiment=%00",
        "/new?experiment=/etc/passwd.py&rig=/etc/passwd",
    ],
)
def test_hostile_paths_reach_nothing_and_are_a_sentence(console: Console, path):
    reply = console.ask(path)
    assert reply.status < 500
    assert "root:" not in reply.body
    assert "import " not in reply.body
    assert "Traceback" not in reply.body


@pytest.mark.parametrize(
    "name",
    [
        "../../x.csv",
        "a\x00b.csv",
        "\u4e00" * 300 + ".csv",
        "x" * 300 + ".csv",
        "C:\\x\\y.csv",
        "..",
        "<b>.csv",
    ],
)
def test_names_of_uploads_stay_in_the_folder(console: Console, name):
    body = (
        f'--b\r\nContent-Disposition: form-data; name="file"; filename="{name}"\r\n\r\n'
        "u,y\r\n1,2\r\n\r\n--b--\r\n"
    ).encode()
    reply = console.ask(
        "/study", "POST", {**console.own, "Content-Type": "multipart/form-data; boundary=b"}, body
    )
    assert reply.status in (303, 400, 422)
    if reply.status == 303:
        assert reply.headers["location"].startswith("/study/")
        assert "<b>" not in console.ask(reply.headers["location"]).body.replace("<br>", "")


def test_an_upload_that_is_too_large_or_has_no_length_is_refused(console: Console):
    more = {"Content-Type": "multipart/form-data; boundary=b"}
    sent = {**console.own, **more, "Content-Length": "500000001"}
    assert console.ask("/study", "POST", sent).status == 422
    assert console.ask("/study", "POST", {**console.own, **more}, iter([b"--b--"])).status == 422


@pytest.mark.parametrize(
    ("path", "method"), [("/", "POST"), ("/stop-all", "GET"), ("/", "PUT"), ("/new", "DELETE")]
)
def test_other_methods_are_refused(console: Console, path, method):
    assert console.ask(path, method).status in (404, 405)


def test_a_huge_query_is_answered(console: Console):
    assert console.ask("/library?" + "a=1&" * 10000).status < 500


@pytest.mark.long("takes three seconds", cases=("15",))
@pytest.mark.parametrize("number", [pytest.param(signal.SIGINT, marks=pytest.mark.long), signal.SIGTERM])
def test_a_signal_ends_it_with_status_0_while_a_stream_is_open(tmp_path, own_running_dir, number):
    info, control = (
        PanelRunInfo("p", "r", "w", "twin", False, "mm", 0.1, 5, 3.0, tmp_path / "a"),
        RunControl(),
    )
    with announced(info, control, RunStatus(info, control)):
        key = runs_in_progress()[0].key
        with (
            started_console(tmp_path / "runs") as console,
            socket.create_connection(("127.0.0.1", console.port), 30) as stream,
        ):
            lines = [f"GET /runs/{key}/follow HTTP/1.1", f"Host: 127.0.0.1:{console.port}"]
            lines += [f"Cookie: {console.own['Cookie']}", "", ""]
            stream.sendall("\r\n".join(lines).encode())
            assert b"200 OK" in stream.recv(4096)
            console.process.send_signal(number)
            assert console.process.wait(60) == 0


def test_a_run_outlives_a_killed_console_and_the_next_one_shows_it(tmp_path, own_running_dir):
    with started_run(tmp_path, *SLOW, "-o", "a.run.sqlite") as process:
        run = found_run(process)
        with started_console(tmp_path) as first, started_console(tmp_path) as second:
            assert run.key in first.ask("/").body
            assert run.key in second.ask("/").body
            os.kill(first.process.pid, signal.SIGKILL)
            newest = run.samples()[1]
            waited(lambda: run.samples(newest)[1] > newest, "samples after the console's end")
            assert second.ask(f"/runs/{run.key}").status == 200
            run.ask("stop", "test")
        assert process.wait(90) == 130
    with stored_run(tmp_path / "a.run.sqlite") as stored:
        assert stored.cause == "stopped by the operator (test)"
        assert stored.stopped_by.kind == "program"


@pytest.mark.long("takes five seconds")
def test_a_killed_run_is_shown_until_it_is_dismissed_also_by_the_next_console(tmp_path, own_running_dir):
    (tmp_path / "runs").mkdir()
    out = tmp_path / "runs" / "a'<b>.run.sqlite"
    with started_run(tmp_path, *SLOW, "-o", str(out)) as process:
        found_run(process)
        with started_console(tmp_path / "runs") as console:
            assert "Ended without finishing" not in console.ask("/").body
            process.kill()
            process.wait()
            text = html.unescape(console.ask("/").body)
    run = rf"Validation on one_wire_twin \(process {process.pid}\), which wrote {re.escape(str(out))},"
    assert re.search(rf"{run} ended at about 20[\d: -]+ without finishing\.", text)
    assert f"smarig resume {shlex.quote(str(out))}" in text
    with started_console(tmp_path / "runs") as console:
        body = console.ask("/overview/parts").body
        assert "without finishing" in body
        assert "<b>" not in body
        place = re.search(r'href="(/library/run[^"]+)"', body)[1]
        reply = console.ask(html.unescape(place))
        assert re.fullmatch(r"/library/[^/?]+", reply.headers["location"])
        assert "incomplete" in console.ask(reply.headers["location"]).body
        before = console.ask("/overview/version").body
        dismiss = re.search(r'action="(/ended/[^"]+/dismiss)"', body)[1]
        assert console.ask(dismiss, "POST").status == 303
        assert "without finishing" not in console.ask("/").body
        assert console.ask("/overview/version").body != before
    with started_console(tmp_path / "runs") as console:
        assert "without finishing" not in console.ask("/").body


@pytest.mark.parametrize("content", ["", "7", "[{}]", '[{"key": 1}]', "[" * 9000, "\udcff"])
def test_a_strange_file_of_ended_runs_is_no_harm(tmp_path, own_running_dir, content):
    (tmp_path / "runs").mkdir()
    (tmp_path / "runs" / "console.ended_runs.json").write_text(content, errors="surrogateescape")
    ended = EndedRuns(ConsoleScope(tmp_path / "runs"))
    assert ended.found() == []
    ended.dismiss("nothing")


def _refusal(tmp_path, *arguments, script=""):
    command = [sys.executable, *(["-c", script] if script else ["-m", "smarig"]), "console", "--no-browser"]
    return subprocess.run([*command, *arguments], cwd=tmp_path, capture_output=True, text=True, timeout=90)


@pytest.mark.long("takes three seconds")
def test_what_it_cannot_start_with_is_one_sentence(tmp_path):
    (tmp_path / "file").touch()
    with socket.socket() as taken:
        taken.bind(("127.0.0.1", 0))
        taken.listen()
        port = str(taken.getsockname()[1])
        done = [
            _refusal(tmp_path, "--folder", "runs", "--port", port),
            _refusal(tmp_path, "--folder", "/proc/runs"),
            _refusal(tmp_path, "--folder", "file"),
        ]
    missing = "import sys; sys.modules['uvicorn'] = None; from smarig.cli import main; main(sys.argv[1:])"
    done.append(_refusal(tmp_path, "--folder", "runs", script=missing))
    for one in done:
        assert one.returncode in (2, 4), one.stderr
        assert len(one.stderr.strip().splitlines()) == 1, one.stderr
        assert "Traceback" not in one.stderr
    assert f"Port {port} cannot be used" in done[0].stderr
    assert "extra 'console'" in done[-1].stderr


@pytest.mark.long("takes three seconds")
def test_the_entry_of_a_run_that_has_ended_is_read_again_when_it_is_opened(tmp_path):
    """Long before the library looks at the folder again."""
    being_recorded = "The run is being recorded."
    with started_run(tmp_path, *SLOW, "-o", "a.run.sqlite") as process:
        found_run(process)
        with started_console(tmp_path) as console:

            def entry():
                return re.search(r'href="(/library/[^"/?]+)"[^>]*>a<', console.ask("/library").body)

            place = html.unescape(waited(entry, "the run in the library")[1])
            assert being_recorded in console.ask(place).body
            process.send_signal(signal.SIGINT)
            process.communicate(timeout=60)
            assert being_recorded not in console.ask(place).body
