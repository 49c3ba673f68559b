"""Short paths and marks draw the same: every corner of a path stays where it was."""

import re

from hypothesis import given
from hypothesis import strategies as st

from report.svg_paths import corners_of
from smarig.report.drawing.compact_svg import short_marks, short_paths

tenths = st.integers(-20_000, 20_000).map(lambda k: k / 10)
lines = st.lists(st.tuples(tenths, tenths), min_size=1, max_size=30)


def absolute(subpaths, closed):
    return "".join(
        "M" + "L".join(f"{x:.10g} {y:.10g}" for x, y in corners) + "z" * closed for corners in subpaths
    )


@given(st.lists(lines, min_size=1, max_size=4), st.booleans())
def test_every_corner_stays_where_it_was(subpaths, closed):
    svg = short_paths(f'<path d="{absolute(subpaths, closed)}" style="stroke:red"/>')
    path = re.search(r' d="([^"]*)"', svg)[1]
    drawn = [[(round(10 * x), round(10 * y)) for x, y in corners] for corners in corners_of(path)]
    assert drawn == [[(round(10 * x), round(10 * y)) for x, y in corners] for corners in subpaths]


def test_a_path_with_curves_stays_as_it_is():
    path = '<path d="M 0 1C 0.2 1 0.5 0.9 0.7 0.7z"/>'
    assert short_paths(path) == path
    assert short_paths('<path d=""/>') == '<path d=""/>'


def test_a_path_is_written_short():
    assert short_paths('<path d="M 78.7 378.9L 107.5 378.3L 107.5 378M 1 0"/>') == (
        '<path d="M78.7 378.9l28.8-.6 0-.3m-106.5-378"/>'
    )


def test_equal_marks_have_one_style():
    a, b = ('<use xlink:href="#m" x="{}" y="2" style="fill:' + colour + '"/>' for colour in ("#000", "#fff"))
    svg = short_marks(a.format(1) + a.format(2) + b.format(3) + "<text/>" + a.format(4))
    assert svg == (
        '<g style="fill:#000"><use xlink:href="#m" x="1" y="2"/><use xlink:href="#m" x="2" y="2"/></g>'
        + b.format(3)
        + "<text/>"
        + a.format(4)
    )
