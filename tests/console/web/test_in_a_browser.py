"""The console in a real browser: a newcomer's way through it by mouse and by keys, and every page for everyone."""

import json
import math
import os
import re
import shutil
import signal
import time
from dataclasses import asdict
from pathlib import Path

import pytest

import smarig

pytest.importorskip("websocket", reason="websocket-client is not installed (pip install smarig[test])")
pytest.importorskip("uvicorn", reason="the extra 'console' is not installed")

from console.web.console_process import ConsoleProcess
from console.web.visitor import Visitor
from report.browser import Browser, axe, chromium
from smarig.console.web.ended_runs import FILE, UnfinishedRun
from smarig.record import load_run

LONG = "/new?experiment=validation&set.points=60&speed=20&out={}.run.sqlite"
SHORT = "/new?experiment=validation&set.points=2&out={}.run.sqlite"
HOT = """base = "one_wire_twin"
name = "hot"
temperature_noise_K = 40.0  # its preview has no noise
temperature_noise_time_s = 1.0
"""
MODEL = Path(__file__).parents[2] / "frozen" / "old_files" / "models" / "one_wire_exponential.model.json"
OUTPUTS = "[...document.querySelectorAll('.scroll tbody tr')].map(x => x.querySelector('td.name').innerText)"


@pytest.fixture(scope="module")
def console(tmp_path_factory):
    chromium()
    folder = tmp_path_factory.mktemp("console")
    (folder / "runs").mkdir()
    (folder / "runs" / "hot.toml").write_text(HOT)
    shutil.copy(MODEL, folder / "runs" / "wire.model.json")
    smarig.run("validation", rig="one_wire_twin", out=folder / "runs" / "recorded_once.run.sqlite", points=2)
    with ConsoleProcess(folder) as running:
        yield running


@pytest.fixture(scope="module")
def visitor(console, tmp_path_factory):
    browser = Browser(tmp_path_factory.mktemp("profile"))
    yield Visitor(browser, console.address)
    browser.close()


def start(visitor, form, name):
    """Start a run by its form, and open its page."""
    visitor.go(form.format(name))
    visitor.click("Start")
    visitor.click("Validation on one_wire_twin")
    visitor.until("!!document.getElementById('live')?.dataset.drawn", "its page")


def stop(visitor):
    """Stop the run of the page that is open, and let the queue go on later."""
    visitor.click("Stop this run")
    visitor.shows("See it in the library")


def let_the_queue_continue(visitor):
    visitor.go("/")
    visitor.click("Continue the queue")
    visitor.shows("The queue continues.")


def test_a_newcomer_starts_a_first_look_by_clicks_and_finds_its_runs(visitor, console):
    visitor.shows("No run of this console is in progress")
    visitor.click("Start one")
    visitor.shows("a first look at a new wire")
    visitor.click("Preview")
    assert "initialise" in visitor.shows("Peak current")
    visitor.click("Start")
    visitor.shows("Ended")
    visitor.until("document.querySelector('td.good')?.innerText.startsWith('done')", "the campaign ends")
    visitor.click("Library")
    visitor.reload_until("document.body.innerText.includes('02_step_currents')")
    visitor.click("02_step_currents")
    visitor.reload_until("document.body.innerText.includes('stroke')")
    runs = sorted((console.folder / "quick_look_001").rglob("*.run.sqlite"))
    assert [load_run(run).cause for run in runs] == ["done"] * 3


def test_a_run_is_paused_continued_and_stopped_by_clicks(visitor, console):
    start(visitor, LONG, "interrupted_once")
    visitor.click("Pause")
    visitor.shows("Paused: the current stays and sampling continues.")
    visitor.click("Continue")
    visitor.until("document.getElementById('state').innerText.startsWith('Step ')", "it goes on")
    first = visitor.until("Number(document.getElementById('live').dataset.drawn)")
    visitor.until(f"document.getElementById('live').dataset.drawn > {first}", "the plots go on")
    stop(visitor)
    visitor.click("See it in the library")
    assert "interrupted_once" in visitor.shows("Tags and notes")
    run = load_run(console.folder / "interrupted_once.run.sqlite")
    assert run.cause == "stopped by the operator (console)"
    assert [e.text for e in run.events if "paused" in e.text.lower() or "continued" in e.text.lower()]
    let_the_queue_continue(visitor)


@pytest.mark.long("takes ten seconds")
def test_a_run_shows_the_boundary_its_events_and_the_residual_of_a_chosen_model(visitor):
    start(visitor, LONG, "watched")
    plane = "document.getElementById('plane')"
    first = visitor.until(f"{plane}.querySelector('.boundary')?.getAttribute('d')", "the boundary")
    visitor.until(f"{plane}.querySelector('.boundary').getAttribute('d') !== {first!r}", "it follows the run")
    words = visitor.tab.run(f"{plane}.getAttribute('aria-label')")
    assert re.fullmatch(r"Preisach plane: present input −?[\d.]+ K, boundary with \d+ corners?", words), words
    labels = visitor.tab.run(f"[...{plane}.querySelectorAll('.label')].map(x => x.textContent)")
    assert labels == ["β, K", "α, K"]
    event = visitor.until(
        "document.querySelector('#events li.none')?.innerText", "an event with its severity"
    )
    assert event.split("\n")[1] == "none"
    assert visitor.tab.run("document.getElementById('residual')") is None
    assert visitor.tab.run("document.querySelectorAll('.plots figure').length") == 3
    visitor.choose("Model over the loop", "wire.model.json")
    visitor.click("Show")
    visitor.shows("Residual: measured position minus that of wire.model.json")
    visitor.until("document.getElementById('live').dataset.drawn > 150", "the wire is hot")
    residual = "Number(document.getElementById('residual').dataset.largest)"
    assert 0 < visitor.until(residual, "a residual") < 2.0  # mm; the travel is 12 mm
    assert visitor.tab.run("document.querySelector('#residual canvas').width") > 300
    visitor.click("Pause")
    visitor.shows("Paused: the current stays and sampling continues.")
    assert "minus that of wire.model.json" in visitor.shows("Residual"), "the chosen model stays"
    stop(visitor)
    let_the_queue_continue(visitor)


@pytest.mark.long("takes ten seconds")
def test_a_console_that_is_stopped_is_told_and_its_page_catches_up(visitor, console):
    start(visitor, LONG, "stopped_console")
    drawn = "Number(document.getElementById('live').dataset.drawn)"
    before = visitor.until(drawn)
    hidden = "document.getElementById('offline').hidden"
    assert visitor.tab.run(hidden)
    os.kill(console.pid, signal.SIGSTOP)
    try:
        visitor.until(f"!{hidden}", "the page says that the console does not answer")
        assert visitor.tab.run("document.getElementById('stop').disabled"), "it would only replace the page"
    finally:
        os.kill(console.pid, signal.SIGCONT)
    visitor.until(
        f"{hidden} && {drawn} > {before} + 40", "it catches up"
    )  # 5 s at 20 times real time are 100 s
    assert not visitor.tab.run("document.getElementById('stop').disabled")
    stop(visitor)
    let_the_queue_continue(visitor)


@pytest.mark.long("takes three seconds")
def test_errors_in_the_list_of_events_are_marked_by_word_and_by_more_than_colour(visitor):
    start(visitor, LONG, "marked")
    visitor.until("!!document.querySelector('#events li')", "an event")
    marks = visitor.tab.run(
        """['none', 'minor', 'major', 'invalid'].map(severity => {
            const item = document.querySelector('#events li').cloneNode(true);
            item.className = severity;
            document.getElementById('events').append(item);
            const style = getComputedStyle(item);
            return [style.fontWeight, style.borderLeftColor, getComputedStyle(item.children[1]).backgroundColor].join();
        })"""
    )
    assert len(set(marks)) == 4, marks
    assert [mark.split(",")[0] for mark in marks] == ["400", "400", "650", "650"]
    stop(visitor)
    let_the_queue_continue(visitor)


NOTIFICATIONS = """(() => {
    const kept = (name) => JSON.parse(sessionStorage.getItem(name) ?? "[]");
    const keep = (name, value) => sessionStorage.setItem(name, JSON.stringify([...kept(name), value]));
    window.Notification = class {
        constructor(title, { body }) { keep("notes", `${title}: ${body}`); }
        static get permission() { return kept("requests").length ? "granted" : "default"; }
        static async requestPermission() { keep("requests", 1); }
    };
})()"""


@pytest.fixture
def notes(visitor):
    """Reads the notifications that the browser was given; it grants permission when it is asked for."""
    call, session = visitor.tab.browser.call, visitor.tab.session
    script = call("Page.addScriptToEvaluateOnNewDocument", session, source=NOTIFICATIONS)["identifier"]
    visitor.go("/")
    visitor.tab.run("sessionStorage.clear()")
    yield lambda name="notes": visitor.tab.run(f"JSON.parse(sessionStorage.getItem('{name}') ?? '[]')")
    call("Page.removeScriptToEvaluateOnNewDocument", session, identifier=script)
    visitor.tab.run("sessionStorage.clear()")
    visitor.go("/")


HIDE = """Object.defineProperty(document, 'visibilityState', { value: 'hidden', configurable: true });
document.dispatchEvent(new Event('visibilitychange'))"""


@pytest.mark.parametrize(
    "is_hidden", [pytest.param(False, marks=pytest.mark.long), pytest.param(True, marks=pytest.mark.long)]
)
def test_the_end_of_a_run_is_in_the_title_and_in_a_notification_that_was_wanted(visitor, notes, is_hidden):
    start(visitor, LONG, f"notified_{is_hidden}")
    assert notes("requests") == []
    usual = visitor.tab.run("document.title")
    assert usual.startswith("Validation on one_wire_twin")
    if not is_hidden:
        visitor.click("Notify me when it ends")
        visitor.shows("This browser will notify you")
        assert len(notes("requests")) == 1
        assert visitor.tab.run("document.getElementById('notify').ariaPressed") == "true"
    stop_request = "fetch(location.pathname + '/stop', { method: 'POST' }).then(() => 0)"
    visitor.tab.run((HIDE + ";" if is_hidden else "") + stop_request)
    visitor.until("document.title === 'Ended: Validation on one_wire_twin'", "the title")
    words = "Ended: Validation on one_wire_twin: Ended: stopped by the operator (console)."
    assert notes() == ([] if is_hidden else [words])
    let_the_queue_continue(visitor)


@pytest.mark.long("takes ten seconds")
def test_the_queue_is_put_in_another_order_while_a_run_is_in_progress(visitor, console):
    start(visitor, LONG, "present")
    for name in ("first", "second"):
        visitor.go(SHORT.format(name))
        visitor.click("Add to the queue")
        visitor.shows(f"{name}.run.sqlite")
    visitor.click("Move second.run.sqlite up")
    visitor.until(
        f"{OUTPUTS}.filter(x => /first|second/.test(x)).join() === 'second.run.sqlite,first.run.sqlite'"
    )
    visitor.click("Validation on one_wire_twin")
    stop(visitor)
    let_the_queue_continue(visitor)
    done = "x => /(first|second).run.sqlite/.test(x.innerText) && x.querySelector('td.good')"
    visitor.until(f"[...document.querySelectorAll('tr')].filter({done}).length === 2", "both end")
    began = {
        name: load_run(console.folder / f"{name}.run.sqlite").info.start_epoch for name in ("first", "second")
    }
    assert began["second"] < began["first"]


def test_a_preview_changes_no_setting(visitor):
    visitor.go(SHORT.format("previewed"))
    seed = "document.getElementById('set.seed')"
    before = visitor.tab.run(f"[{seed}.value, {seed}.placeholder]")
    visitor.fill("Seed of the noise", "7")
    visitor.click("Preview")
    visitor.shows("Peak current")
    assert visitor.tab.run(f"[{seed}.value, {seed}.placeholder]") == before == ["", "1"]
    assert visitor.tab.run("document.getElementById('seed').value") == "7"


def test_a_fault_of_the_rig_is_seen_and_the_queue_pauses(visitor, notes):
    visitor.click("Notify me when a run ends")
    visitor.shows("This browser will notify you")
    visitor.go("/new?experiment=validation&rig=hot.toml&set.points=3&out=hot.run.sqlite")
    visitor.click("Start")
    visitor.until("document.querySelector('td.bad')?.innerText.includes('position jumped')", "the fault")
    assert "The queue is paused." in visitor.shows("failed")
    visitor.until("document.title === 'Queue paused'", "the title")
    assert "position jumped" in notes()[-1]
    visitor.tab.key("Tab", 9)
    assert visitor.tab.run("document.title").startswith("Runs")
    let_the_queue_continue(visitor)


def test_a_rig_is_brought_up_by_clicks(visitor):
    """Its list of checks is that of the command; the list of rigs then says that it is fit."""
    visitor.go("/rigs")
    visitor.click("one_wire_serial")
    visitor.click("Check the rig")
    visitor.shows("Fit to run. Checked at")
    checks = visitor.tab.run(
        "[...document.querySelectorAll('[aria-label=Checks] tbody td:first-child')].map(x => x.innerText)"
    )
    assert {"devices", "at rest", "read-back", "encoder direction", "lease"} <= set(checks)
    visitor.click("All rigs")
    row = "[...document.querySelectorAll('tbody tr')].find(x => x.innerText.startsWith('one_wire_serial'))"
    visitor.until(f"{row}?.innerText.includes('Fit to run')", "its state in the list")


def test_a_rig_whose_devices_are_not_given_says_so_before_anybody_starts_it(visitor):
    visitor.go("/rigs")
    visitor.click("bench_one_wire")
    visitor.shows("links.amplifier.url is the placeholder")
    assert "New run on this rig" not in visitor.tab.run("document.body.innerText")
    visitor.go("/new?rig=bench_one_wire")
    visitor.shows("This rig is not ready")
    assert visitor.tab.run("document.querySelector('button.primary').disabled")


def test_a_run_is_searched_tagged_and_described(visitor):
    visitor.go("/library")
    visitor.fill("Words", "RECORDED_ONCE")
    visitor.click("Search")
    visitor.shows("1 entry")
    visitor.click("recorded_once")
    visitor.fill("Tags", "wire A, to repeat")
    visitor.click("Save the tags")
    visitor.shows("The tags were saved.")
    visitor.fill("New note", "The load <b>slipped</b>.")
    visitor.click("Add the note")
    visitor.shows("The load <b>slipped</b>.")
    visitor.go("/library?tag=to+repeat")
    assert "recorded_once" in visitor.shows("1 entry")
    visitor.go("/library?text=nothing-of-the-kind")
    visitor.shows("Nothing in this folder matches.")


@pytest.mark.long("takes ten seconds")
def test_a_model_is_verified_by_clicks_and_the_command_follows_the_choice(visitor, console):
    shutil.copy(MODEL, console.folder / "another.model.json")
    visitor.go("/library?text=recorded_once")
    visitor.click("recorded_once")
    visitor.reload_until("document.querySelectorAll('#choice-verify option').length === 2")
    command = "document.querySelector('#verify pre').innerText"
    for name in ("another", "wire"):
        of_name = f"find(x => x.innerText === '{name}.model.json')"
        found = visitor.tab.run(f"[...document.querySelectorAll('#choice-verify option')].{of_name}.value")
        visitor.choose("Model", found)
        assert visitor.tab.run(command).startswith(f"smarig verify {console.folder}/{name}.model.json ")
    visitor.click("Verify a model on it")
    visitor.shows("Verdict: ")  # without a click


@pytest.mark.long("takes five seconds")
def test_a_figure_of_a_page_is_explored_in_the_console(visitor, console):
    """The page has no access to the console, but the script of its figures."""
    visitor.go("/library?text=recorded_once")
    visitor.click("recorded_once")
    entry = visitor.tab.run("location.pathname")
    visitor.click("Make its page")
    visitor.reload_until("!!document.querySelector('iframe')")
    assert "made before this run continued" not in visitor.shows("Tags and notes")
    later = time.time() + 60
    os.utime(console.folder / "recorded_once.run.sqlite", (later, later))
    visitor.reload_until("document.body.innerText.includes('made before this run continued')")
    visitor.go(f"{entry}/page")
    visitor.until("[...document.querySelectorAll('button')].some(b => b.innerText === 'Explore')", "figures")
    visitor.click("Explore")
    visitor.until(
        "!!document.querySelector('.js-plotly-plot .main-svg')", "the figure can be turned and zoomed"
    )


def european(folder):
    """A loop as a German instrument writes it: semicolons between the columns, commas in the numbers."""
    rows = ["Zeit (s);Temperatur (°C);Weg (mm)"]
    for k in range(900):
        warm = 60 - 40 * math.cos(k / 40)
        y = 1.5 * math.tanh((warm - (65 if math.sin(k / 40) > 0 else 50)) / 10)
        rows.append(f"{k / 2:.1f};{warm:.3f};{y:.4f}".replace(".", ","))
    file = folder / "Messung 1.csv"
    file.write_text("\n".join(rows), encoding="utf-8")
    return file


@pytest.mark.long("takes ten seconds")
def test_a_file_with_decimal_commas_is_studied_by_clicks(visitor, tmp_path):
    visitor.go("/study")
    dropped = """(() => { const data = new DataTransfer(); data.items.add(new File(["1"], "dropped.csv"));
        const drop = new DragEvent("drop", { dataTransfer: data, bubbles: true, cancelable: true });
        return [document.body.dispatchEvent(drop), document.getElementById("file").files[0].name]; })()"""
    assert visitor.tab.run(dropped) == [False, "dropped.csv"], "anywhere; the browser does not open it"
    visitor.give("Data file", european(tmp_path))
    visitor.click("Read the columns")
    text = visitor.shows("First rows as read")
    assert "-1.4" in text
    guessed = [visitor.tab.run(f"document.getElementById('{name}').value") for name in ("input", "output")]
    assert guessed == ["Temperatur (°C)", "Weg (mm)"]
    visitor.click("Study it")
    shown = visitor.shows("The file was studied.")
    assert re.search(r"The model \(positive measure\) (fits|predicts) .* (good|fair|poor)", shown), (
        "its verdict"
    )
    visitor.until("document.querySelector('iframe').clientHeight > 300", "the style sheet is applied")


@pytest.mark.long("takes three seconds")
def test_a_run_is_started_with_keys_alone(visitor, console):
    visitor.go(SHORT.format("keys"))
    for _ in range(60):
        visitor.tab.key("Tab", 9)
        if visitor.tab.run("document.activeElement.innerText") == "Start":
            break
    visitor.tab.key("Enter", 13)
    visitor.shows("was added to the queue")
    visitor.until(
        "[...document.querySelectorAll('tr')].some(x => /keys.run.sqlite.*done/s.test(x.innerText))",
        "it ends",
    )
    assert load_run(console.folder / "keys.run.sqlite").cause == "done"


@pytest.fixture(scope="module")
def pages(visitor, console):
    """Where each page is; those of a run need one in progress. The overview also has a run that was killed."""
    killed = UnfinishedRun("1-2", "It ended.", f"{console.folder.resolve()}/{'long_' * 30}/a.run.sqlite")
    (console.folder / FILE).write_text(json.dumps([asdict(killed)]))
    start(visitor, LONG, "a_long_name_that_somebody_has_given_to_a_run_on_purpose")
    run = visitor.tab.run("location.pathname")
    visitor.go("/library?text=recorded_once")
    entry = visitor.tab.run("document.querySelector('tbody a').pathname")
    wire = visitor.tab.run("document.querySelector('#wire option:last-child').value")
    yield {
        "overview": "/",
        "other folders": "/elsewhere",
        "new campaign": "/new",
        "new run": SHORT.format("x"),
        "run": run,
        "run with a model": run + "?model=wire.model.json",
        "phone": run + "/phone",
        "library": "/library",
        "entry": entry,
        "trends": f"/library/trends?wire={wire}",
        "study": "/study",
        "rigs": "/rigs",
        "rig": "/rigs/rig?rig=one_wire_serial",
        "problem": "/nothing",
        "run that has ended": "/runs/nothing",
    }
    visitor.go(run)
    stop(visitor)


PAGES = (
    "overview",
    "other folders",
    "new campaign",
    "new run",
    "run",
    "run with a model",
    "phone",
    "library",
    "entry",
    "trends",
    "study",
    "rigs",
    "rig",
    "problem",
)


LONG_VIEW = pytest.mark.long("takes ten seconds")
VIEWS = [
    (1280, False),
    (400, True),
    pytest.param(400, False, marks=LONG_VIEW),
    pytest.param(1280, True, marks=LONG_VIEW),
]


@pytest.mark.parametrize(("width", "dark"), VIEWS)
def test_everyone_can_read_every_page_on_a_desk_and_on_a_phone_by_day_and_by_night(
    visitor, pages, width, dark
):
    """All pages in one test, for each worker needs a console, a browser and a run for them."""
    axe()
    tab = visitor.tab
    found = {}
    for name in (*PAGES, "run that has ended"):
        visitor.go(pages[name])
        try:
            visitor.until(
                "!document.getElementById('plane') || !!document.querySelector('#plane svg')", "the plane"
            )
            tab.resize(width)
            tab.dark(dark)
            visitor.until(f"document.documentElement.scrollWidth === {width}", f"{name} scrolls sideways")
            found[name] = tab.violations()
        finally:
            tab.resize(1280)
            tab.dark(False)
    assert found == {name: [] for name in found}


def test_nothing_complained_and_nothing_left_the_machine(visitor, console):
    complaints = [
        text for text in visitor.tab.complaints() if "404" not in text
    ]  # of pages that a test asked for
    assert complaints == []
    root = console.address.partition("?")[0]
    assert [url for url in visitor.tab.requests() if not url.startswith(root)] == []
