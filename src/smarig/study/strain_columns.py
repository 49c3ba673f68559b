"""Which of several strains is that along the load: by its name, or by its agreement with a measured elongation."""

import re
from collections.abc import Sequence

import numpy as np

from smarig.core import correlation
from smarig.exchange import convert, dimension
from smarig.study.column_guess import ColumnGuess

_ALONG = re.compile(
    r"axial|longitud|l(ä|ae)ngs|tensile|zugrichtung|extensom|(\bd|\bdelta|Δ|∆) ?l ?/ ?l", re.IGNORECASE
)
_OTHER = re.compile(  # across the load, or of a gauge that no load strains
    r"lateral|transver|quer|radial|\bdiam|shear|scher|\be(xy|yz|xz)\b|"
    r"dummy|compens|kompens|\bspare\b|unloaded|unbelastet",
    re.IGNORECASE,
)
_SAME_RANGE = 0.5  # least ratio of the ranges of two strains that show one motion


def axial_strain(strains: Sequence[ColumnGuess]) -> ColumnGuess:
    """The first strain that is along the load, as its name or its agreement with one that is named so says; the first
    one that is neither across it nor of a gauge without load where nothing says so.
    """
    able = [c for c in strains if not _is_named(_OTHER, c)] or list(strains)
    along = next((c for c in able if _is_named(_ALONG, c)), able[0])
    return next(c for c in able if c is along or show_one_motion(c, along))


def other_strains(out: ColumnGuess, strains: Sequence[ColumnGuess]) -> list[ColumnGuess]:
    """The strains that differ from that of the output, where no name says which of them is along the load."""
    able = [c for c in strains if not _is_named(_OTHER, c)]
    if any(_is_named(_ALONG, c) for c in able):
        return []
    return [
        c
        for c in able
        if c is not out and dimension(c.unit) == dimension(out.unit) and not show_one_motion(c, out)
    ]


def _is_named(words: re.Pattern[str], c: ColumnGuess) -> bool:
    return words.search(re.sub(r"[_.:-]+", " ", f"{c.label} {c.facts.comment}")) is not None


def show_one_motion(a: ColumnGuess, b: ColumnGuess) -> bool:
    """Whether two strains or displacements show one motion, but for its zero."""
    if dimension(a.unit) != dimension(b.unit):
        return False
    known = np.isfinite(a.facts.values) & np.isfinite(b.facts.values)
    spans = sorted((convert(a.facts.span, a.unit, b.unit), b.facts.span))
    together = correlation(a.facts.values[known], b.facts.values[known]) > 0
    return together and spans[0] >= _SAME_RANGE * spans[1]
