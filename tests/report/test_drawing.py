"""Drawings of panels: the data are where the axes say, and every part that pages use is drawn."""

import re
import xml.etree.ElementTree as ET

import numpy as np
import pytest

from report.svg_paths import corners_of
from smarig.core import UsageError
from smarig.report.components.figure import Figure, Panel, axis, dots, line, log_axis, packed
from smarig.report.components.page import Section, page
from smarig.report.components.style import DASHES, SYMBOLS
from smarig.report.drawing import figures_saved_in, save_figure, svg_of
from smarig.report.drawing.compact_svg import compact_svg
from smarig.report.drawing.plotly_schema import plain_text

BLUE = "#0072b2"
LAYOUT = {"xaxis": axis("u (K)"), "yaxis": axis("y (mm)")}
EVIL = "</svg><script>alert('x')</script>$\\frac{"


def texts(svg):
    """The texts of a drawing in order."""
    return [
        "".join(each.itertext()).strip() for each in ET.fromstring(svg).iter() if each.tag.endswith("}text")
    ]


def path_of(svg, colour):
    """Points (k, 2) in pixels of the line of a colour."""
    paths = [p.get("d") for p in ET.fromstring(svg).iter() if colour in (p.get("style") or "") and p.get("d")]
    return np.array([corner for part in corners_of(max(paths, key=len)) for corner in part])


def test_points_are_where_the_ticks_say():
    """Pixels are a linear map of the data, upward positive, the same one as that of the labelled ticks."""
    x, y = np.array([0.0, 3.0, 7.0, 10.0]), np.array([0.0, 5.0, -2.0, 4.0])
    fixed = {
        "xaxis": axis("u (K)", range=[0, 10], tickvals=[0, 10]),
        "yaxis": axis("y (mm)", range=[-4, 6], tickvals=[-4, 6]),
    }
    drawn = path_of(svg_of(Panel([line(x, y, "a", BLUE)], fixed)), BLUE)
    frame = path_of(svg_of(Panel([line([0, 10, 10, 0], [-4, -4, 6, 6], "a", BLUE)], fixed)), BLUE)
    left, below, right, above = *frame[0], *frame[2]
    np.testing.assert_allclose(drawn[:, 0], left + x / 10 * (right - left), atol=0.2)
    np.testing.assert_allclose(drawn[:, 1], below + (y + 4) / 10 * (above - below), atol=0.2)
    assert above < below
    assert right > left


def test_a_gap_stays_a_gap():
    svg = svg_of(Panel([line([0, 1, 2, 3], [0, 1, np.nan, 3], "a", BLUE)], LAYOUT))
    (path,) = [
        p.get("d")
        for p in ET.fromstring(svg).iter()
        if BLUE in (p.get("style") or "") and "l" in p.get("d", "")
    ]
    assert [len(part) for part in corners_of(path)] == [2, 1]


def test_titles_names_and_the_label_of_simulated_data_are_written():
    layout = LAYOUT | {"title": {"text": "A<sub>s</sub>"}}
    svg = svg_of(
        Panel([line([0, 1], [0, 1], "measured", BLUE), dots([0], [1], "model", "#000")], layout), "TWIN"
    )
    found = texts(svg)
    for words in ("u (K)", "y (mm)", "measured", "model", "TWIN"):
        assert words in found
    assert "As" in re.sub(r"\s", "", "".join(found))
    assert "TWIN" not in texts(svg_of(Panel([line([0, 1], [0, 1], "a", BLUE)], LAYOUT)))


def test_small_numbers_keep_their_digits():
    """Coordinates are shortened, numbers at ticks are not."""
    layout = {"xaxis": axis("u"), "yaxis": axis("y", tickvals=[0.004, -0.0125])}
    found = texts(svg_of(Panel([line([0, 1], [-0.02, 0.02], "a", BLUE)], layout | {"showlegend": False})))
    assert {"0.004", "−0.0125"} & set(found) or {"0.004", "-0.0125"} <= set(found)
    raised = texts(svg_of(Panel([line([0, 1], [1e-7, 2e-7], "a", BLUE)], LAYOUT)))
    assert any("10⁻⁷ mm" in text for text in raised), "the power stands with the unit, away from the legend"


def test_nothing_a_person_typed_becomes_markup():
    layout = {"xaxis": axis(EVIL), "yaxis": axis(EVIL)}
    svg = svg_of(Panel([line([0, 1], [0, 1], EVIL, BLUE), line([0, 1], [1, 0], "b", BLUE)], layout))
    assert "<script" not in svg
    assert ET.fromstring(svg) is not None
    assert any("alert" in text for text in texts(svg))


@pytest.mark.parametrize(
    "symbol", [*SYMBOLS, "triangle-up", "diamond-open", "star", "hexagram-open", "x-thin"]
)
def test_every_symbol_of_the_pages_is_drawn(symbol):
    svg = svg_of(Panel([dots([0, 1], [0, 1], "a", BLUE, symbol=symbol)], LAYOUT))
    assert BLUE in svg


@pytest.mark.parametrize("dash", [*DASHES, "7px,5px"])
def test_every_dash_of_the_pages_is_drawn(dash):
    svg = svg_of(Panel([line([0, 1], [0, 1], "a", BLUE, dash=dash)], LAYOUT))
    assert ("stroke-dasharray" in svg) == (dash != "solid")


def test_what_is_hidden_is_not_drawn():
    hidden = line([0, 1], [0, 1], "a", BLUE) | {"visible": False}
    assert BLUE not in svg_of(Panel([hidden, line([0, 1], [0, 1], "b", "#000000")], LAYOUT))


def test_rows_share_their_abscissa():
    layout = {
        "xaxis": axis("t (s)", anchor="y2"),
        "yaxis": {"title": {"text": "above"}, "domain": [0.5, 1]},
        "yaxis2": {"title": {"text": "below"}, "domain": [0, 0.47]},
    }
    traces = [
        line([0, 1], [0, 1], "a", BLUE, yaxis="y"),
        line([0, 2], [5, 6], "b", "#d55e00", yaxis="y2"),
    ]
    svg = svg_of(Panel(traces, layout | {"showlegend": False}))
    upper, lower = path_of(svg, BLUE), path_of(svg, "#d55e00")
    assert upper[:, 1].max() < lower[:, 1].min()
    assert upper[0, 0] == pytest.approx(lower[0, 0], abs=0.2)
    assert upper[1, 0] == pytest.approx((lower[0, 0] + lower[1, 0]) / 2, abs=0.3)


def test_a_logarithmic_axis_has_plain_numbers():
    layout = {"xaxis": axis("u"), "yaxis": log_axis("rms", 0.004, 0.6)}
    svg = svg_of(Panel([line([0, 1, 2], [0.005, 0.05, 0.5], "a", BLUE)], layout))
    steps = np.diff(path_of(svg, BLUE)[:, 1])
    assert steps[0] == pytest.approx(steps[1], abs=0.3)
    assert {"0.005", "0.05", "0.5"} <= set(texts(svg))


def test_maps_bars_surfaces_and_error_bars_are_drawn():
    z = np.outer(np.arange(4.0), np.arange(3.0))
    heat = {"type": "heatmap", "x": packed([0, 1, 2]), "y": packed([0, 1, 2, 3]), "z": packed(z)}
    heat |= {
        "colorscale": "Cividis",
        "colorbar": {"title": {"text": "share"}},
        "text": [["", "", "50"]] + [[""] * 3] * 3,
    }
    found = texts(svg_of(Panel([heat], LAYOUT)))
    assert "share" in found
    assert "50" in found
    bar = {
        "type": "bar",
        "x": packed([1.0, -2.0]),
        "y": packed([0, 1]),
        "text": ["one", "two"],
        "marker": {"color": BLUE},
    }
    assert {"one", "two"} <= set(texts(svg_of(Panel([bar], LAYOUT))))
    surface = {"type": "surface", "colorscale": "Cividis", **{k: packed(z) for k in "xyz"}}
    scene = {"scene": {f"{k}axis": {"title": {"text": f"{k} (K)"}} for k in "xyz"}}
    assert {"x (K)", "y (K)", "z (K)"} <= set(texts(svg_of(Panel([surface], scene))))
    bars = {"type": "data", "symmetric": False, "array": [2.0], "arrayminus": [1.0], "color": "#cc79a7"}
    svg = svg_of(
        Panel([dots([0.0], [5.0], "a", BLUE, error_y=bars), line([0, 1], [0, 10], "b", "#000000")], LAYOUT)
    )
    assert "#cc79a7" in svg


def test_the_same_panel_gives_the_same_text_and_others_other_ids():
    one, two = (Panel([line([0, k], [0, 1], "a", BLUE)], LAYOUT) for k in (1, 2))
    assert svg_of(one) == svg_of(one)
    ids = [set(re.findall(r' id="([^"]*)"', svg_of(panel))) for panel in (one, two)]
    assert ids[0]
    assert not ids[0] & ids[1]


def test_only_ids_that_something_refers_to_remain():
    svg = svg_of(Panel([line([0, 1], [0, 1], "a", BLUE), dots([0], [1], "b", "#000")], LAYOUT))
    for name in re.findall(r' id="([^"]*)"', svg):
        assert f"#{name}" in svg
    image = '<svg><g><g a="1"><image xlink:href="data:image/png;base64,A1.123456"/><text>0.0045</text></g></g></svg>'
    assert compact_svg("<?xml?>" + image) == image.replace("<svg>", "<svg>").replace("<g><g", "<g").replace(
        "</g></g>", "</g>"
    )


@pytest.mark.parametrize(("end", "start"), [(".svg", b"<?xml"), (".pdf", b"%PDF"), (".png", b"\x89PNG")])
def test_a_panel_becomes_a_file(tmp_path, end, start):
    save_figure(Panel([line([0, 1], [0, 1], "a", BLUE)], LAYOUT), tmp_path / "loop", end, "TWIN")
    assert (tmp_path / "loop").read_bytes().startswith(start)


@pytest.mark.long("takes three seconds")
def test_the_figures_of_a_page_are_saved_while_it_is_made(tmp_path):
    panels = [Panel([line([0, k], [0, 1], "a", BLUE)], LAYOUT) for k in (1, 2)]
    one, two = Figure(panels[:1], "Hysteresis: μ of the run.", [], ""), Figure(panels, "Errors", [], "")
    with figures_saved_in(tmp_path / "new") as files:
        page("t", "", [Section("s", "s", [one, two])])
    names = ["01-hysteresis-mu-of-the-run", "02-errors--panel-1", "02-errors--panel-2"]
    assert [file.name for file in files] == [f"{name}.{end}" for name in names for end in ("svg", "pdf")]
    assert all(file.stat().st_size > 500 for file in files)
    with figures_saved_in(tmp_path / "new"), pytest.raises(UsageError, match="exists"):
        one.html()
    one.html()  # outside of the block nothing is saved


def test_markup_of_labels():
    assert plain_text("R<sub>M</sub><br>&lt; 5 &amp; <b>6</b> $") == "$\\mathregular{R_{M}}$\n< 5 & 6 \\$"
