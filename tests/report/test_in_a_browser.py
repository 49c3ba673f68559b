"""Every kind of page in a browser without a network: with mouse, keyboard and screen reader, and on a phone."""

import pytest

pytest.importorskip("websocket", reason="websocket-client is not installed (pip install smarig[test])")

import smarig
from report.browser import Browser, axe, chromium
from smarig.cli import run as cli
from smarig.plant.effect_catalogue import effects_from_pairs
from smarig.rig.twin import TwinSettings
from smarig.runner.session import Session

KINDS = ("run", "index", "comparison", "models", "characterise", "diagnose", "regulate", "certificate")
# Read on a desk, too, where there is time.
ON_A_PHONE = ("comparison", "characterise", "diagnose", "regulate", "certificate")
LONG = pytest.mark.long("takes up to five seconds; tried on a phone")


def smarig_(*words):
    assert cli([str(word) for word in words]) == 0


@pytest.fixture(scope="module")
def pages(tmp_path_factory, drawings, characterised):
    """A page of each kind, made as people make them."""
    chromium()
    folder = tmp_path_factory.mktemp("pages")
    runs = folder / "runs"
    for name, seed, effects in (("first", 1, []), ("second", 2, []), ("walked", 1, ["walking=2"])):
        with Session(
            "one_wire_twin", twin=TwinSettings(seed=seed, effects=effects_from_pairs(effects))
        ) as session:
            session.run("validation", {"points": 6}, runs / f"{name}.run.sqlite")
    out = characterised.copied(folder)
    curves = out / "runs" / "04_first_order_descending.run.sqlite"
    models = [folder / f"{surface}.model.json" for surface in ("exponential", "table")]
    for surface, model in zip(("exponential", "table"), models):
        smarig.identify(curves, surface).model.save(model)
    first, second, walked = (runs / f"{name}.run.sqlite" for name in ("first", "second", "walked"))
    smarig_("report", runs)
    smarig_("report", first, second, walked, "-o", folder / "comparison.html")
    smarig_("report", "--model", models[0], "--model", models[1], first, walked, "-o", folder / "models.html")
    held = folder / "held.run.sqlite"
    words = (
        "--setpoint",
        6,
        "--within",
        0.2,
        "--hold-s",
        100,
        "--disturbance-K",
        6,
        "--rig",
        "one_wire_twin",
        "--quiet",
    )
    smarig_("regulate", models[0], *words, "-o", held)
    smarig_("report", held, "--model", models[0], "-o", folder / "held.html")
    smarig_("certify", models[0], "-o", folder / "certificate.html")
    return {
        "regulate": folder / "held.html",
        "certificate": folder / "certificate.html",
        "run": runs / "first.html",
        "index": runs / "index.html",
        "comparison": folder / "comparison.html",
        "models": folder / "models.html",
        "characterise": out / "report.html",
        "diagnose": out / "diagnosis" / "report.html",
    }


@pytest.fixture(scope="module")
def browser(tmp_path_factory):
    running = Browser(tmp_path_factory.mktemp("profile"))
    yield running
    running.close()


@pytest.fixture(scope="module")
def opened(browser, pages):
    """Opens a page of a kind, once."""
    tabs = {}

    def opening(kind, width=1280):
        if kind not in tabs:
            tabs[kind] = browser.open(pages[kind])
        tabs[kind].resize(width)
        return tabs[kind]

    return opening


@pytest.mark.parametrize("kind", KINDS)
def test_nothing_complains_and_nothing_leaves(opened, pages, kind):
    tab = opened(kind)
    assert tab.complaints() == []
    assert set(tab.requests()) == {pages[kind].resolve().as_uri()}


@pytest.mark.parametrize("kind", KINDS)
def test_a_page_is_small(pages, kind):
    assert pages[kind].stat().st_size < 1.0e6


@pytest.mark.parametrize(
    ("kind", "width"),
    [
        pytest.param(kind, width, marks=[LONG] if width == 1280 and kind in ON_A_PHONE else [])
        for kind in KINDS
        for width in (1280, 400)
    ],
)
def test_everyone_can_read_it_on_a_desk_and_on_a_phone(opened, kind, width):
    axe()
    tab = opened(kind, width)
    assert tab.run("document.documentElement.scrollWidth") == width, "it scrolls sideways"
    assert tab.run("document.querySelector('.twinbar').getBoundingClientRect().bottom") < 120
    assert tab.violations() == []


GROUND = "getComputedStyle(document.querySelector('{}')).backgroundColor"


@pytest.mark.parametrize("kind", [pytest.param(k, marks=[LONG] if k in ON_A_PHONE else []) for k in KINDS])
def test_everyone_can_read_it_in_the_dark(opened, kind):
    """Text on a dark ground; figures keep their white one, on which their colours can be told apart."""
    axe()
    tab = opened(kind, 1280)
    try:
        tab.dark()
        assert tab.run(GROUND.format("body")) == "rgb(18, 22, 27)"
        if tab.run("document.querySelector('.plot') !== null"):
            assert tab.run(GROUND.format(".plot")) == "rgb(255, 255, 255)"
        assert tab.violations() == []
    finally:
        tab.dark(False)
    assert tab.run(GROUND.format("body")) == "rgb(255, 255, 255)"


PLOTS = (
    "[...document.querySelectorAll('.plot')].map(p => [p.ariaLabel, p.role, p.textContent, p.offsetHeight])"
)


@pytest.mark.parametrize("kind", [kind for kind in KINDS if kind != "index"])
def test_every_figure_is_drawn_labelled_and_described(opened, kind):
    plots = opened(kind).run(PLOTS)
    assert plots
    for words, role, drawn, height in plots:
        assert role == "img"
        assert words.startswith("TWIN, simulated. ")
        assert " against " in words
        assert "TWIN" in drawn
        assert height > 150


def explore(tab, k=0):
    """Press the k-th Explore button, and wait for what it shows."""
    tab.run(
        f"[...document.querySelectorAll('.tools button')].filter(b => b.innerText === 'Explore')[{k}].click()"
    )
    return tab.run(
        """new Promise(done => { const look = () => {
        const live = document.querySelector('.live .main-svg, .live canvas');
        const said = [...document.querySelectorAll('.tools button')].find(b => b.disabled);
        live || said ? done(said ? said.innerText : 'drawn') : setTimeout(look, 50); }; look(); })"""
    )


def test_a_page_without_its_library_states_what_it_needs(browser, pages, tmp_path):
    alone = tmp_path / "alone.html"
    alone.write_bytes(pages["run"].read_bytes())
    tab = browser.open(alone)
    assert explore(tab) == "The file smarig-figures.js is missing beside this page."
    assert tab.run("document.querySelector('.plot svg').getBoundingClientRect().height") > 100
    tab.close()


# --- the index ------------------------------------------------------------------------------------------

SHOWN = """[...document.querySelectorAll('{} [data-run]')]
    .filter(x => !x.hidden).map(x => x.querySelector('a').innerText)"""


def names(tab, where):
    return tab.run(SHOWN.format(where))


def test_the_index_is_searched_and_ordered_by_keys_alone(opened):
    tab = opened("index")
    tab.key("Tab", 9)
    assert tab.run("document.activeElement.className") == "skip"
    tab.run("document.querySelector('[type=search]').focus()")
    tab.type("VALID seco")
    assert names(tab, "tbody") == names(tab, ".gallery") == ["second"]
    assert tab.run("document.querySelector('[role=status]').innerText") == "1 of 3 runs"
    tab.run("document.querySelector('[type=search]').select()")
    tab.type("nothing of the kind")
    assert names(tab, "tbody") == []
    tab.run("const s = document.querySelector('[type=search]'); s.select(); s")
    tab.key("Delete", 46)
    tab.run("[...document.querySelectorAll('th button')].find(b => b.innerText.startsWith('Seed')).focus()")
    tab.key("Enter", 13)
    assert names(tab, "tbody") == names(tab, ".gallery") == ["first", "walked", "second"]
    tab.key("Enter", 13)
    assert names(tab, "tbody")[0] == "second"
    assert tab.run("document.querySelector('th[data-key=seed]').ariaSort") == "descending"


@pytest.mark.long("takes ten seconds")
def test_a_choice_in_a_figure_is_a_button_that_keys_reach(browser, pages):
    tab = browser.open(pages["characterise"])
    tab.run("document.querySelectorAll('details').forEach(each => each.open = true)")
    assert explore(tab, 1) == "drawn"  # 0: the loops
    second = "document.querySelectorAll('.choices button')[1]"
    tab.run(f"{second}.focus()")
    tab.key("Enter", 13)
    assert tab.run(f"{second}.ariaPressed") == "true"
    surfaces = "document.querySelector('.live').data.filter(t => t.type === 'surface' && t.visible)"
    shown = tab.run(f"{surfaces}.map(t => t.name)")
    assert shown == [tab.run(f"{second}.innerText")]
    tab.close()


@pytest.mark.parametrize("kind", KINDS)
def test_on_paper_the_controls_are_hidden_and_the_twin_label_is_not(opened, kind):
    tab = opened(kind)
    tab.on_paper()
    try:
        for controls in ("nav", ".tools", ".search"):
            assert tab.run(f"[...document.querySelectorAll('{controls}')].every(x => !x.offsetHeight)")
        assert tab.run("document.querySelector('.twinbar').offsetHeight") > 10
        assert tab.run("document.documentElement.scrollWidth") <= 703
    finally:
        tab.on_paper(False)
