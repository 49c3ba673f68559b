"""The components of pages: escaping, packed arrays, decimation that keeps peaks, and atomic writing."""

import base64
import gzip
import json
import os
import re
from dataclasses import replace

import numpy as np
import plotly.graph_objects as go
import pytest

from report.pages import Page, unpacked
from smarig.core.errors import StorageError, UsageError
from smarig.report.components.decimate import envelope, path
from smarig.report.components.figure import Figure, Panel, axis, line, packed
from smarig.report.components.html import Html, table, tag
from smarig.report.components.page import LIBRARY, Section, page, write_page
from smarig.report.runs.sample_path import sample_path

EVIL = "</script><script>alert('x')</script><img src=http://evil.example/a.png>"


def figure(name: str = "y", label: str = "TWIN") -> Figure:
    layout = {"xaxis": axis("u (K)"), "yaxis": axis(f"{name} (mm)")}
    return Figure([Panel([line([0, 1, np.nan], [2, 3, 4], name, "#000")], layout)], name, [name], label)


def test_text_is_escaped_and_markup_is_not():
    assert tag("p", "a < b & c", Html("<b>d</b>")) == "<p>a &lt; b &amp; c<b>d</b></p>"
    assert 'title="&quot;&gt;"' in tag("p", title='">')
    assert "&lt;i&gt;" in table(("<i>",), [("x",)])


def test_nothing_a_person_typed_becomes_markup_anywhere():
    text = page(EVIL, EVIL, [Section(EVIL, EVIL, [tag("p", EVIL), figure(EVIL)])], label="TWIN")
    parsed = Page(text)
    assert not [attrs for name, attrs in parsed.tags if name == "img"]
    assert (
        len([1 for name, _ in parsed.tags if name == "script"]) == 2
    )  # one figure, and the script of figures
    assert EVIL in parsed.visible
    name = parsed.plots[0]["data"][0]["name"]
    assert "<" not in name, "Plotly reads markup in names"


def test_the_script_of_figures_is_there_once_and_only_where_there_is_a_figure():
    plain = page("t", "", [Section("s", "s", [tag("p", "no figure")])])
    drawn = page("t", "", [Section("s", "s", [figure(), figure()]), Section("r", "r", [figure()])])
    assert len(plain) < 20_000
    assert [text.count("function explore") for text in (plain, drawn)] == [0, 1]
    assert len(Page(drawn).plots) == 3


def explored(html):
    """The data of the figures that can be explored."""
    found = re.findall(r'class="explored">([^<]*)</script>', html)
    return [json.loads(gzip.decompress(base64.b64decode(text))) for text in found]


def test_the_library_is_beside_pages_that_can_be_explored_and_only_there(tmp_path):
    panel = replace(figure().panels[0], explore=True)
    page_html = page("t", "", [Section("s", "s", [Figure([panel], "t", [], "TWIN")])])
    write_page(page("t", "", [Section("s", "s", [figure()])]), tmp_path / "a" / "plain.html")
    write_page(page_html, tmp_path / "b" / "turned.html")
    assert not (tmp_path / "a" / LIBRARY).exists()
    assert (tmp_path / "b" / LIBRARY).stat().st_size > 1_000_000
    (spec,) = explored(page_html)
    assert spec["data"][0]["name"] == "y"
    assert spec["layout"]["annotations"][0]["text"] == "TWIN"


def test_arrays_come_back_with_their_gaps_and_shape():
    values = np.array([[1.5, np.nan, -2.0], [0.0, 1e-9, 3.0]])
    np.testing.assert_array_equal(unpacked(packed(values)), values)
    np.testing.assert_allclose(unpacked(packed(values, single=True)), values, rtol=1e-6)


def test_no_figure_holds_what_json_cannot_say():
    layout = Panel([], {"range": [0, float("nan")]})
    with pytest.raises(ValueError, match="JSON"):
        Figure([layout], "t", [], "").html()


def test_a_twin_is_labelled_in_the_banner_the_title_and_each_plot():
    text = page("t", "", [Section("s", "s", [figure(), figure()])], label="TWIN")
    parsed = Page(text)
    banner = [attrs for name, attrs in parsed.tags if attrs.get("class") == "twinbar"]
    assert banner
    assert parsed.visible.lstrip().startswith("TWIN")
    assert all(any(a["text"] == "TWIN" for a in p["layout"]["annotations"]) for p in parsed.plots)
    bench = Page(page("t", "", [Section("s", "s", [figure(label="")])]))
    assert "TWIN" not in bench.visible
    assert "annotations" not in bench.plots[0]["layout"]


def test_the_label_stands_at_the_frame_where_axes_of_one_scale_leave_paper_empty():
    free = Figure(
        [Panel([], {"xaxis": axis("u (K)"), "yaxis": axis("y (mm)")}, explore=True)], "t", [], "TWIN"
    )
    plane = Figure(
        [Panel([], {"xaxis": axis("β (K)", constrain="domain"), "yaxis": axis("α (K)")}, explore=True)],
        "t",
        [],
        "TWIN",
    )
    marks = [explored(each.html())[0]["layout"]["annotations"][0] for each in (free, plane)]
    assert [(m["xref"], m["yref"]) for m in marks] == [("paper", "paper"), ("x domain", "y domain")]


def test_a_stacked_table_names_the_column_of_each_value():
    header = ("Name", Html("k<sub>e</sub> (mm)"), "<i>")
    cells = [attrs for name, attrs in Page(table(header, [("a", 1, 2)], stacked=True)).tags if name == "td"]
    assert cells == [{"data-column": "k_e (mm)"}, {"data-column": "<i>"}]
    assert "data-column" not in table(header, [("a", 1, 2)])


def test_a_decimated_trace_keeps_every_peak_and_stays_short():
    rng = np.random.default_rng(4)
    values = rng.normal(size=100_000)
    values[[70, 70_007]] = 50, -60
    kept = envelope(values, 800)
    assert kept.size <= 800
    assert np.all(np.diff(kept) > 0)
    assert {70, 70_007} <= set(kept.tolist())
    for k in range(0, 100_000, 250):  # the drawn trace reaches both extremes of every stretch
        assert values[kept[(kept >= k) & (kept < k + 250)]].max() == values[k : k + 250].max()
    loop = path(np.cos(values), np.sin(values), 500)
    assert loop.size <= 500


def test_a_thinned_path_has_the_shape_of_the_whole():
    """No chord: between the points that are kept, none of the others is far from the line that is drawn."""
    angle = np.linspace(0, 40 * np.pi, 6001)  # twenty loops with corners
    u, y = 150 + 100 * np.cos(angle), np.tanh(4 * np.sin(angle - 0.3))
    kept = path(u, y, 700)
    assert kept.size <= 700
    row = np.arange(u.size)
    drawn_u, drawn_y = np.interp(row, kept, u[kept]), np.interp(row, kept, y[kept])
    finer = np.linspace(0, u.size - 1, 40 * u.size)
    drawn = np.column_stack([np.interp(finer, row, drawn_u) / 200, np.interp(finer, row, drawn_y) / 2])
    for k in range(0, u.size, 7):
        near = slice(40 * max(k - 40, 0), 40 * (k + 40))
        assert np.hypot(*(drawn[near] - (u[k] / 200, y[k] / 2)).T).min() < 0.006
    gap = np.where((row > 2000) & (row < 4000), np.nan, y)
    assert np.isnan(gap[path(u, gap, 700)]).any()


def test_the_path_of_a_long_run_keeps_every_sample_of_a_fast_move():
    """As a large step of the current gives: the wire heats by several kelvin a tick, while holds fill the run."""
    hold, move = np.zeros(60_000), np.linspace(0.0, 1.0, 21)[1:]
    u = np.concatenate([hold, move, hold + 1.0])
    y = u**4
    kept = sample_path(u, y)
    assert set(range(60_000, 60_020)) <= set(kept.tolist())
    assert kept.size < 100


@pytest.mark.parametrize("n", [41, 999, 1000, 4321])
def test_decimation_keeps_the_first_extreme_of_each_segment(n: int):
    rng = np.random.default_rng(n)
    values = np.round(rng.normal(size=n), 1)  # extremes occur several times
    values[rng.random(n) < 0.3] = np.nan
    edges = np.linspace(0, n, 21).astype(int)
    wanted = set()
    for a, b in zip(edges[:-1], edges[1:]):
        segment = values[a:b]
        extremes = [np.nanargmin(segment), np.nanargmax(segment)] if np.isfinite(segment).any() else [0]
        wanted |= {a + int(k) for k in extremes}
    assert envelope(values, 40).tolist() == sorted(wanted)


def test_gaps_stay_gaps_when_decimated():
    values = np.concatenate([np.ones(5000), np.full(5000, np.nan), np.ones(5000)])
    drawn = values[envelope(values, 300)]
    assert np.isnan(drawn).any()
    assert np.isfinite(drawn).sum() == 100


def test_a_page_is_never_overwritten_by_accident(tmp_path):
    target = tmp_path / "new" / "report.html"
    write_page("one", target)
    with pytest.raises(UsageError, match="--force"):
        write_page("two", target)
    assert target.read_text() == "one"
    write_page("two", target, force=True)
    assert target.read_text() == "two"
    assert [p.name for p in target.parent.iterdir()] == ["report.html"]


def test_an_unwritable_page_gives_one_sentence(tmp_path):
    (tmp_path / "file").write_text("")
    with pytest.raises(UsageError, match="not a folder"):
        write_page("x", tmp_path / "file" / "report.html")
    with pytest.raises(UsageError, match="is a folder"):
        write_page("x", tmp_path)
    if os.geteuid() != 0:
        (tmp_path / "shut").mkdir(mode=0o500)
        with pytest.raises(StorageError, match="cannot be written"):
            write_page("x", tmp_path / "shut" / "report.html")


def test_a_failed_write_leaves_the_old_page_and_no_part(tmp_path, monkeypatch):
    target = write_page("old", tmp_path / "report.html")

    def full(*_, **__):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr("pathlib.Path.replace", full)
    with pytest.raises(StorageError, match="No space left"):
        write_page("new", target, force=True)
    assert target.read_text() == "old"
    assert [p.name for p in tmp_path.iterdir()] == ["report.html"]


def test_the_template_is_one_plotly_accepts():
    from smarig.report.components.style import template

    go.Figure(layout={"template": template()})
    assert json.dumps(template())


def test_a_figure_cannot_end_its_own_script():
    text = Figure([Panel([], {"title": {"text": "</script><script>alert(1)"}})], "t", [], "").html()
    assert text.count("<script") == text.count("</script>") == 1
    assert Page(text).plots[0]["layout"]["title"]["text"] == "</script><script>alert(1)"
