"""Everything in a folder is found again: by words, tags, wire, dates; with its verdict, figures and trends."""

import json
import shutil

import numpy as np
import pytest

from console.library.folders import (
    DAY_S,
    EPOCH,
    FROZEN,
    contents,
    make_model,
    make_page,
    make_run,
    places,
    refreshed,
)
from smarig.cli import run
from smarig.console import FACETS, ORDERS, Library
from smarig.console.library.run_content import heating_cycles
from smarig.core import UsageError
from smarig.record import Wear, load_run
from smarig.transformation import headline


@pytest.fixture
def folder(tmp_path):
    """Three runs of two wires, a model, pages, a diagnosis with a page and one without."""
    make_run(tmp_path / "a.run.sqlite", 0, cycles=1, notes="after the Ångström test")
    make_run(tmp_path / "week 2" / "b.run.sqlite", 7, cycles=1, stroke=4.5, seed=3)
    make_run(tmp_path / "c.run.sqlite", 14, wire="spool 8", rig="other", protocol="validation")
    make_model(tmp_path / "wire.model.json")
    make_page(tmp_path / "study" / "index.html")
    make_page(tmp_path / "found" / "report.html", "diagnosis", "Named: slip.", "bad")
    (tmp_path / "transient").mkdir()
    for name in ("found", "transient"):
        shutil.copy(FROZEN / "box" / "diagnosis" / "diagnosis.json", tmp_path / name)
    (tmp_path / "notes.html").write_text("<html><title>mine</title></html>")
    (tmp_path / "diagnosis.json").write_text('{"verdict": "of a court"}')
    return tmp_path


def test_everything_in_the_folder_is_an_entry(folder):
    library = refreshed(folder)
    kinds = {entry.place: entry.kind for entry in library.search().entries}
    assert kinds == {
        "a.run.sqlite": "run",
        "week 2/b.run.sqlite": "run",
        "c.run.sqlite": "run",
        "wire.model.json": "model",
        "study/index.html": "study",
        "found/report.html": "diagnosis",
        "transient/diagnosis.json": "diagnosis",
    }
    assert not [entry.error for entry in library.search().entries if entry.error]
    assert {entry.path.name for entry in library.search().entries if entry.path.is_file()} == {
        *("a.run.sqlite", "b.run.sqlite", "c.run.sqlite", "wire.model.json", "index.html"),
        *("report.html", "diagnosis.json"),
    }


def test_an_entry_says_what_its_run_holds(folder):
    library = refreshed(folder)
    (entry,) = library.search("ångström").entries
    stored = load_run(folder / "a.run.sqlite")
    assert (entry.name, entry.wire, entry.rig) == ("a", "spool 7", "bench_one_wire")
    assert (entry.began, entry.duration_s) == (EPOCH, pytest.approx(23.9))
    assert (entry.verdict, entry.sentence) == ("good", "The run ended as planned.")
    assert entry.details["settings"] == {"points": "120"}
    assert (entry.details["samples"], entry.details["cause"]) == (240, "done")
    for name, estimate in headline(stored).items():
        assert entry.figures[name].value == estimate.value
        assert entry.figures[name].ci95 == estimate.ci95
    assert entry.figures["stroke"].unit == "mm"
    u, y = library.loop(entry.id)
    assert u.size == y.size > 10
    assert (u.min(), u.max()) == (0.0, 100.0)
    assert library.entry(entry.id) == entry


def test_models_pages_and_diagnoses_say_what_they_found(folder):
    library = refreshed(folder)
    model, page, without = (
        library.search(text).entries[0] for text in ("wire.model.json", "found/report", "transient")
    )
    about = json.loads((folder / "wire.model.json").read_text())
    assert model.figures["error_times_noise"].value == about["fit"]["rms"] / about["noise_floor"]["value"]
    assert (page.verdict, page.sentence, page.name) == ("bad", "Named: slip.", "A title")
    assert (without.verdict, without.sentence, without.name) == ("bad", "named: slip", "transient")
    assert library.loop(page.id)[1].tolist() == [0.0, 2.0]


@pytest.mark.parametrize(
    ("question", "found"),
    [
        ({"text": "B.RUN"}, {"week 2/b.run.sqlite"}),
        ({"text": "spool constant_force"}, {"a.run.sqlite", "week 2/b.run.sqlite"}),
        ({"text": "spool nonsense"}, set()),
        ({"text": "% _ '"}, set()),
        ({"text": "points=120 validation"}, {"c.run.sqlite"}),
        ({"wire": "spool 8"}, {"c.run.sqlite"}),
        ({"rig": "other"}, {"c.run.sqlite"}),
        ({"protocol": "validation"}, {"c.run.sqlite"}),
        ({"kind": "model"}, {"wire.model.json"}),
        ({"kind": "diagnosis", "verdict": "bad"}, {"found/report.html", "transient/diagnosis.json"}),
        ({"kind": "run", "since": EPOCH + DAY_S}, {"week 2/b.run.sqlite", "c.run.sqlite"}),
        (
            {"since": EPOCH - 1, "until": EPOCH + 8 * DAY_S, "kind": "run"},
            {"a.run.sqlite", "week 2/b.run.sqlite"},
        ),
        ({"text": "\ud800"}, set()),
        ({"wire": "\ud800"}, set()),
    ],
)
def test_a_search_finds_what_has_all_of_it(folder, question, found):
    assert set(places(refreshed(folder), **question)) == found


def test_tags_and_notes_are_found_and_counted(folder):
    library = refreshed(folder)
    (entry,) = library.search("b.run").entries
    library.tag(entry.id, ["Paper", "  slow   drift ", "paper"], "Ann")
    noted = library.note(entry.id, "The clamp <b>slipped</b>\nat noon.", "Bo")
    assert noted.tags == ("Paper", "slow drift")
    assert [(n.text, n.who) for n in noted.notes] == [("The clamp <b>slipped</b>\nat noon.", "Bo")]
    for question in (
        {"tags": ["PAPER"]},
        {"tags": ["paper", "slow drift"]},
        {"text": "CLAMP"},
        {"text": "slow bo"},
    ):
        assert places(library, **question) == ["week 2/b.run.sqlite"], question
    assert places(library, tags=["paper", "none"]) == []
    assert library.facets()["tag"] == {"Paper": 1, "slow drift": 1}
    assert library.tag(entry.id, ["slow drift"], "Cy").tags == ("slow drift",)
    assert places(library, tags=["paper"]) == []


@pytest.mark.parametrize("tag", ["", "  ", "a,b", "x" * 61, "a\x1bb"])
def test_what_is_no_tag_is_refused(folder, tag):
    library = refreshed(folder)
    before = contents(library)
    with pytest.raises(UsageError, match="is no tag"):
        library.tag(library.search("a.run").entries[0].id, [tag])
    with pytest.raises(UsageError, match="A note has"):
        library.note(library.search("a.run").entries[0].id, " ")
    assert contents(library) == before
    assert not (folder / "library.notes.jsonl").exists()


def test_facets_count_every_value(folder):
    found = refreshed(folder).facets()
    assert tuple(found) == FACETS
    assert found["kind"] == {"run": 3, "diagnosis": 2, "model": 1, "study": 1}
    assert {"spool 7": 2, "spool 8": 1}.items() <= found["wire"].items()
    assert found["verdict"] == {"good": 4, "bad": 2}


def test_every_order_and_the_pages_hold_each_entry_once(folder):
    library = refreshed(folder)
    for order in ORDERS:
        whole = places(library, order=order)
        pages = [places_of(library, order, k) for k in range(0, 8, 3)]
        assert [place for page in pages for place in page] == whole
        assert len(set(whole)) == 7
    assert places(library, kind="run", order="newest") == [
        "c.run.sqlite",
        "week 2/b.run.sqlite",
        "a.run.sqlite",
    ]
    assert places(library, kind="run", order="oldest")[0] == "a.run.sqlite"
    assert library.search(limit=0).total == 7
    assert library.search(offset=10**30).entries == ()
    for wrong in ({"order": "best"}, {"limit": -1}, {"limit": 10**6}, {"offset": -1}):
        with pytest.raises(UsageError):
            library.search(**wrong)


def places_of(library, order, offset):
    return [entry.place for entry in library.search(order=order, limit=3, offset=offset).entries]


def test_trends_are_the_figures_of_the_runs_of_a_wire_in_time(folder):
    make_run(folder / "early.run.sqlite", -7, cycles=1, stroke=5.2)
    shutil.copy(folder / "a.run.sqlite", folder / "copy of a.run.sqlite")
    library = refreshed(folder)
    found = library.trends("spool 7")
    runs = {entry.id: entry for entry in library.search(wire="spool 7", kind="run").entries}
    assert {"stroke", "A_s", "A_f", "M_s", "M_f"} <= set(found)
    for name, trend in found.items():
        assert trend.epochs.tolist() == [EPOCH - 7 * DAY_S, EPOCH, EPOCH + 7 * DAY_S]
        assert trend.values.tolist() == [runs[id].figures[name].value for id in trend.ids]
        assert trend.intervals.tolist() == [list(runs[id].figures[name].ci95) for id in trend.ids]
        assert trend.unit == runs[trend.ids[0]].figures[name].unit
    np.testing.assert_allclose(found["stroke"].values, [5.2, 5.0, 4.5], rtol=0.01)
    assert library.trends("no such wire") == {}


def test_the_error_of_models_is_a_trend_of_their_wire(tmp_path):
    model = make_model(tmp_path / "m.model.json")
    about = json.loads(model.read_text())
    about["provenance"] = [one | {"wire": "spool 7"} for one in about["provenance"]]
    model.write_text(json.dumps(about))
    trend = refreshed(tmp_path).trends("spool 7")["error_times_noise"]
    assert trend.values.tolist() == [about["fit"]["rms"] / about["noise_floor"]["value"]]
    assert trend.intervals is None


def test_figures_in_several_units_have_a_trend_each(tmp_path):
    make_run(tmp_path / "a.run.sqlite", 0, cycles=1)
    make_run(tmp_path / "b.run.sqlite", 1, cycles=1, output={"quantity": "strain", "unit": "%"})
    found = refreshed(tmp_path).trends("spool 7")
    assert found["stroke (mm)"].values.size == found["stroke (%)"].values.size == 1
    assert "stroke" not in found
    assert found["A_s"].values.size == 2


@pytest.mark.long("takes three seconds")
def test_cycles_are_those_of_the_history_of_a_wire_and_add_up(tmp_path):
    """A twin's run: the range of its rig comes from the run, and the count agrees with ``Wear``."""
    made = tmp_path / "a.run.sqlite"
    assert (
        run(["run", "validation", "--rig", "one_wire_twin", "--set", "points=12", "-o", str(made), "--quiet"])
        == 0
    )
    shutil.copy(made, tmp_path / "b.run.sqlite")
    again = tmp_path / "c.run.sqlite"
    assert (
        run(
            ["run", "validation", "--rig", "one_wire_twin", "--set", "points=12", "-o", str(again), "--quiet"]
        )
        == 0
    )
    library = refreshed(tmp_path)
    (entry,) = library.search("a.run").entries
    stored = load_run(made)
    wear = Wear(174.1, 0.1)  # the input at the largest current of the rig (section 5.4.1)
    for tick, value in enumerate(stored["input"].tolist()):
        wear.add(tick, value)
    assert wear.cycles > 1
    assert entry.figures["cycles"].value == wear.cycles
    assert library.trends(entry.wire)["cycles"].values.tolist() == [wear.cycles, 2 * wear.cycles]


@pytest.mark.parametrize("seed", range(5))
def test_cycles_are_counted_as_wear_counts_them(seed):
    u = 100 * np.sin(np.arange(2000) / 40) + np.random.default_rng(seed).normal(0, 15, 2000)
    wear = Wear(100.0, 0.1, u[0])
    for tick, value in enumerate(u.tolist()):
        wear.add(tick, value)
    assert heating_cycles(u, 100.0) == wear.cycles > 3


def test_an_unknown_id_is_refused_in_a_sentence(folder):
    library = refreshed(folder)
    for use in (
        library.entry,
        library.loop,
        lambda id: library.tag(id, ["x"]),
        lambda id: library.note(id, "x"),
    ):
        with pytest.raises(UsageError, match="no entry nonsense"):
            use("nonsense")


def test_a_missing_folder_is_refused(tmp_path):
    with pytest.raises(UsageError, match="There is no folder"):
        Library.open(tmp_path / "no")
