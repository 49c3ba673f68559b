"""Evaluations from the library: the commands of the command line with a chosen model, while the console answers."""

import html
import re
import shlex
import shutil
import time
from pathlib import Path
from urllib.parse import urlencode

import pytest

import smarig
from console.web.started_console import Console, started_console
from running.started_run import waited

MODEL = Path(__file__).parents[2] / "frozen" / "old_files" / "models" / "one_wire_exponential.model.json"
FORM = {"Content-Type": "application/x-www-form-urlencoded"}


@pytest.fixture(scope="module")
def folder(tmp_path_factory) -> Path:
    """A run, and two models; names with what a shell reads as its own."""
    folder = tmp_path_factory.mktemp("console") / "runs"
    folder.mkdir()
    smarig.run("validation", rig="one_wire_twin", out=folder / "an MODEL's.run.sqlite", points=3)
    for name in ("first", "the second"):
        shutil.copy(MODEL, folder / f"{name}.model.json")
    return folder


@pytest.fixture(scope="module")
def console(folder):
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("SMARIG_RUNNING_DIR", str(folder.parent / "running"))
        with started_console(folder) as found:
            waited(lambda: "3 entries" in found.ask("/library").body, "the entries")
            yield found


@pytest.fixture(scope="module")
def place(console: Console) -> str:
    return re.search(r'href="(/library/[\w-]+)">', console.ask("/library?kind=run").body)[1]


def started(console: Console, place: str, job: str, model: str = ""):
    return console.ask(
        f"{place}/evaluate", "POST", {**console.own, **FORM}, urlencode({"job": job, "choice": model})
    )


def models(console: Console, place: str) -> dict[str, str]:
    """The identities of the models by name."""
    found = re.findall(r'<option value="([\w-]+)"[^>]*>([^<]+)</option>', console.ask(place).body)
    return {name: id for id, name in found}


def shown(console: Console, place: str, name: str) -> str:
    """What the page shows of an evaluation."""
    body = console.ask(place).body
    return re.search(rf'<form [^>]*id="{name}">.*?</form>', body, re.DOTALL)[0]


def result(console: Console, place: str, name: str) -> str:
    """The same when it has ended, as text."""

    def ended() -> str:
        text = shown(console, place, name)
        return html.unescape(text) if "notice" in text and "Being computed" not in text else ""

    return waited(ended, f"the end of {name}")


def test_the_commands_name_each_model_as_a_shell_reads_them(console, folder, place):
    text = shown(console, place, "verify")
    commands = [html.unescape(c) for c in re.findall('data-command="(smarig verify [^"]*)"', text)]
    files = [shlex.split(command)[2:] for command in commands]
    run = str(folder / "an MODEL's.run.sqlite")
    assert sorted(files) == [[str(folder / f"{name}.model.json"), run] for name in ("first", "the second")]
    assert html.unescape(re.search("<pre.*?><code>(.*)</code>", text)[1]) == commands[0]


def test_a_model_is_verified_on_a_run(console, place):
    chosen = models(console, place)["the second.model.json"]
    assert started(console, place, "verify", chosen).headers["location"] == f"{place}#verify"
    text = result(console, place, "verify")
    assert "rms error" in text
    assert "Verdict: " in text
    assert "the second.model.json" in re.search("<pre><code>(.*?)</code>", text)[1]
    assert re.search("<option ([^>]*)>the second.model.json", text)[1].endswith(" selected")
    assert html.unescape(shown(console, place, "verify")) == text  # also when it is loaded again
    assert "Being computed" not in shown(console, place, "diagnose")


@pytest.mark.long("takes five seconds")
def test_a_diagnosis_is_computed_while_the_console_answers_and_its_page_is_in_the_library(
    console, folder, place
):
    chosen = models(console, place)["first.model.json"]
    before_s = time.monotonic()
    started(console, place, "diagnose", chosen)
    assert time.monotonic() - before_s < 2
    text = shown(console, place, "diagnose")
    assert "Being computed since" in text
    assert "<button disabled>Diagnose</button>" in text
    version = console.ask(f"{place}/evaluations").body
    again = started(console, place, "diagnose", chosen)
    assert again.status == 422
    assert "This evaluation is being computed already." in again.body
    for path in ("/", "/library", place):
        began_s = time.monotonic()
        assert console.ask(path).status == 200
        assert time.monotonic() - began_s < 2
    text = result(console, place, "diagnose")
    assert console.ask(f"{place}/evaluations").body != version
    assert "notice bad" not in text, text
    assert (folder / "an MODEL's.diagnosis_first" / "diagnosis.json").is_file()
    link = waited(
        lambda: re.search(
            r'<a href="(/library/[\w-]+)">Open its page</a>', shown(console, place, "diagnose")
        ),
        "its page",
    )
    assert console.ask(f"{link[1]}/page").status == 200


def test_what_a_command_refuses_is_its_sentence(console, folder, place):
    (folder / "an MODEL's.model.json").mkdir()  # where the model would be written
    started(console, place, "identify")
    text = result(console, place, "identify")
    assert "notice bad" in text
    assert "an MODEL's.model.json" in text
    assert "is a directory." in text


@pytest.mark.parametrize(("job", "model"), [("verify", ""), ("diagnose", "nothing"), ("rm", ""), ("", "")])
def test_an_evaluation_that_cannot_be_is_refused(console, place, job, model):
    assert started(console, place, job, model).status == 422


def test_a_surface_is_chosen_for_the_identification(console, place):
    text = shown(console, place, "identify")
    assert re.findall('<option value="([^"]+)"', text)[0] == "best"
    assert "exponential.model.json" in html.unescape(
        re.search('data-command="([^"]*exponential[^"]*)"', text)[1]
    )
    assert started(console, place, "identify", "exponential").headers["location"] == f"{place}#identify"
    text = result(console, place, "identify")
    assert "--surface exponential" in text
    assert started(console, place, "identify", "round").status == 422


def test_what_a_run_was_started_with_is_shown(console, place):
    body = console.ask(place).body
    conditions = re.search("<caption>Conditions</caption>.*?</table>", body, re.DOTALL)[0]
    assert "points = " in conditions
