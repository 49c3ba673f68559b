"""The glossary of a page: the terms that occur on it, with their meanings, read from docs/reference/glossary.md."""

import html
import re
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache

from smarig.core import shipped
from smarig.report.components.html import Html, joined, tag

# Words that carry their everyday meaning on a page.
_EVERYDAY = """
operator state memory measure slope inverse wire load cycle effect stage reference error offset reading resolution
score label scope bias preview passive frame link mark event command step hold sample run model figure report simulate
session segment gap import export prediction verification candidate training evidence quality explanation critique
plausible drift limit input output rule plateau
"""
_PLAIN = frozenset(_EVERYDAY.split())
_ALSO = {  # other written forms
    "confidence interval": ("95 % interval",),
    "error verdict": tuple(
        f"noise {kind}: {level}" for kind in ("floor", "of a reading") for level in ("good", "fair", "poor")
    ),
    "FOD surface": ("fod",),
    "first-order curve": (
        "first-order descending curve",
        "first-order ascending curve",
        "first-order descending",
    ),
    "held-out data": ("held-out", "held out"),
    "reversal curve": ("forc", "first-order reversal curve"),
    "removable share": ("share removed",),
    "rms error": ("rms",),
}
_SECTION_OF_SOFTWARE = "## Software"


@dataclass(frozen=True)
class Term:
    """An entry of the glossary: its name, meaning, symbols with unit, and an anchor."""

    name: str
    meaning: str
    symbols: str

    @property
    def anchor(self) -> str:
        """The id of the entry in a page."""
        return "term-" + re.sub(r"\W+", "-", self.name.lower())

    @property
    def written(self) -> tuple[str, ...]:
        """How the term is written on a page, in small letters: its name, and its symbols that have a subscript."""
        name = re.sub(r" \(.*\)", "", self.name).lower()
        symbols = [symbol.strip().lower() for symbol in self.symbols.split(",")]
        subscripted = [symbol for symbol in symbols if re.fullmatch(r"[a-z]_[a-z]{1,2}", symbol)]
        return name, *_ALSO.get(self.name, ()), *subscripted


@cache
def terms() -> tuple[Term, ...]:
    """All terms that need an explanation on a page, in the order of the glossary."""
    text = (shipped("docs") / "reference" / "glossary.md").read_text(encoding="utf-8")
    rows = [line for line in text.split(_SECTION_OF_SOFTWARE)[0].splitlines() if line.startswith("| **")]
    cells = [[cell.strip(" *") for cell in row.strip("| ").split("|")] for row in rows]
    return tuple(
        Term(name, meaning, symbols.replace("`", ""))
        for name, meaning, symbols, *_ in cells
        if name not in _PLAIN
    )


@cache
def _pattern() -> tuple[re.Pattern[str], dict[str, Term]]:
    """The pattern of all written forms, the longest first, and the term of each."""
    by_form = {form: term for term in terms() for form in term.written}
    forms = sorted(by_form, key=lambda form: len(form), reverse=True)
    return re.compile(rf"(?<![\w-])({'|'.join(map(re.escape, forms))})s?(?![\w-])", re.IGNORECASE), by_form


def terms_in(body: str) -> list[Term]:
    """The terms that occur in the text of a page's body, in the order of the alphabet."""
    visible = re.sub(r"<script.*?</script>|<style.*?</style>", "", body, flags=re.DOTALL)
    text = html.unescape(re.sub(r"<[^>]*>", "", visible.replace("<sub>", "_")))
    pattern, by_form = _pattern()
    found = {by_form[form.lower()] for form in pattern.findall(text)}
    return sorted(found, key=lambda term: term.name.lower())


def glossary(used: Sequence[Term]) -> Html:
    """A list of terms with their meanings; empty without terms."""
    entries = [
        joined(
            (
                tag("dt", term.name, id=term.anchor, data_written="|".join(term.written)),
                tag("dd", term.meaning, _unit(term)),
            )
        )
        for term in used
    ]
    return tag("dl", *entries, class_="glossary") if entries else Html("")


def _unit(term: Term) -> Html:
    """The symbols and the unit of a term, with subscripts set as such."""
    shown = re.sub(r"(^|, )1$", "", term.symbols)  # no unit
    written = re.sub(r"\b(\w)_([^\W\d_]{1,2})\b", r"\1<sub>\2</sub>", html.escape(shown))
    return joined((" ", tag("span", Html(written)))) if written else Html("")
