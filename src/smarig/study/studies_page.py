"""The page that compares the studies of many files: their loops, and a table that can be sorted."""

from collections import Counter
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from smarig.report import (
    Html,
    Section,
    bullets,
    cards,
    display_unit,
    found_page,
    number,
    page,
    paragraph,
    tag,
    thumbnail,
)
from smarig.study.rates_page import rate_parts
from smarig.study.study_files import VERDICT_LEVELS, outcome_word

if TYPE_CHECKING:
    from smarig.study.each_file import FileOutcome

_RANK = {"poor": 0, "fair": 1, "good": 2}
_MOST_NAMED = 6
_COLUMNS = (
    "File",
    "Verdict",
    "rms",
    "Unit",
    "% of range",
    "× noise",
    "Best simple curve",
    "Held out",
    "Diagnosis",
)


def studies_page(outcomes: "Sequence[FileOutcome]", name: str) -> str:
    """The HTML page: how many models are good, the loop and a row of each file, and the files that failed."""
    done = [o for o in outcomes if o.found is not None]
    failed = [o for o in outcomes if o.failed]
    left_out = [o for o in outcomes if o.left_out]
    sections = [Section("", "Result", [*_counts(done, len(failed)), *_look_first(done), *_compared(done)])]
    if done:
        words = "Output against input as recorded, vermilion rising and blue falling; each loop has axes of its own."
        sections.append(Section("The loop of every file", "Loops", [_gallery(done), paragraph(words)]))
        sections.append(
            Section("Every file in numbers", "Table", [_table(done), tag("script", Html(SORT_SCRIPT))])
        )
    if failed:
        sections.append(
            Section("Files that failed", "Failed", [bullets([f"{o.file}: {o.failure}" for o in failed])])
        )
    if left_out:
        files = bullets([f"{o.file}: {o.left_out}" for o in left_out])
        sections.append(Section("Files that are no data", "Left out", [files], folded=True))
    tried = len(done) + len(failed)
    lead = f"{len(done)} of {tried} files were studied, each on its own page, in the order of their names"
    return page(f"Studies of {name}", lead, sections)


def _compared(done: "Sequence[FileOutcome]") -> list[Any]:
    """Which files hold the loop of another one with another zero of the output, and whose temperatures go with the
    rate.
    """
    zeros = [o.other_zero for o in done if o.other_zero]
    trends = [o.over_rates for o in done if o.over_rates]
    return [*([bullets(zeros)] if zeros else []), *(part for t in trends for part in rate_parts(t))]


def _counts(done: "Sequence[FileOutcome]", failed: int) -> list[Html]:
    """How many models are good, fair and poor, and how many files have none; nothing if no file was to have one."""
    verdicts = Counter(o.found["verdict"] for o in done if o.found)
    if not failed and verdicts.keys() == {None}:
        return []
    items = [(word.capitalize(), *_counted("model", verdicts[word])) for word in ("good", "fair", "poor")]
    items += [("Without an output", *_counted("file", verdicts[None]))] if verdicts[None] else []
    return [cards([*items, ("Failed", *_counted("file", failed))])]


def _counted(noun: str, count: int) -> tuple[str, str]:
    return str(count), noun if count == 1 else f"{noun}s"


def _look_first(done: "Sequence[FileOutcome]") -> list[Html]:
    """Links to the poor models, the largest errors first."""
    poor = sorted(
        (o for o in done if o.found and o.found["verdict"] == "poor"), key=lambda o: -_share(o.found)
    )
    if not poor:
        return []
    links: list[Any] = []
    for o in poor[:_MOST_NAMED]:
        links += [", " if links else "", _link(o)]
    more = f" and {len(poor) - _MOST_NAMED} more" if len(poor) > _MOST_NAMED else ""
    return [
        paragraph(
            "Look first at ",
            *links,
            f"{more}: {'their models are' if len(poor) > 1 else 'its model is'} poor.",
        )
    ]


def _link(outcome: "FileOutcome") -> Html:
    folder = Path(outcome.folder).name
    return tag("a", folder, href=f"{folder}/index.html")


def _share(found: dict[str, Any] | None) -> float:
    return float(((found or {}).get("held_out") or {}).get("nrmse") or 0.0)


def _gallery(done: "Sequence[FileOutcome]") -> Html:
    return tag("ul", *(_card(o, o.found or {}) for o in done), class_="gallery")


def _card(outcome: "FileOutcome", found: dict[str, Any]) -> Html:
    """The thumbnail of a file's loop, its verdict and its error."""
    shown = found_page(Path(outcome.folder) / "index.html")
    about = shown.summary if shown is not None else None
    drawn = (
        thumbnail(about.u, about.y, f"Loop of {Path(outcome.folder).name}.", about.units)
        if about
        else Html("")
    )
    verdict = found.get("verdict")
    error = f", {number(100 * _share(found), 2)} % of the range" if verdict else ""
    classes = f"level {VERDICT_LEVELS[verdict]}" if verdict in VERDICT_LEVELS else ""
    return tag("li", drawn, _link(outcome), tag("p", tag("b", outcome_word(found)), error), class_=classes)


def _table(done: "Sequence[FileOutcome]") -> Html:
    heads = [tag("th", words, scope="col") for words in _COLUMNS]
    rows = [tag("tr", *_cells(o, o.found or {}, k)) for k, o in enumerate(done)]
    caption = tag("caption", "Files in the order of their names. A click on a column sorts by it.")
    table = tag("table", caption, tag("thead", tag("tr", *heads)), tag("tbody", *rows), class_="sortable")
    return tag("div", table, class_="table", tabindex=0)


def _cells(outcome: "FileOutcome", found: dict[str, Any], place: int) -> list[Html]:
    """The cells of a row, each with the value by which it is sorted."""
    held, split = found.get("held_out") or {}, found.get("split") or {}
    noise, rms = held.get("noise_floor"), held.get("rms")
    ratio = rms / noise if noise and rms is not None else None
    simple = min((found.get("simple_curves") or {}).values(), default=None)
    share = 100 * held["nrmse"] if held.get("nrmse") is not None else None
    verdict, unit = found.get("verdict"), display_unit(found.get("unit") or "")
    diagnosis = (found.get("diagnosis") or {}).get("verdict", "–")
    rest: list[tuple[Any, Any]] = [
        (outcome_word(found), _RANK.get(verdict or "", 3)),
        (number(rms), rms),
        (unit, unit),
        (number(share, 2) if share is not None else "–", share),
        (number(ratio, 2) if ratio is not None else "–", ratio),
        (number(simple), simple),
        (split.get("kind", ""), split.get("kind", "")),
        (diagnosis, diagnosis),
    ]
    first = tag("th", _link(outcome), scope="row", data_sort=f"{place}")
    return [first, *(tag("td", shown, data_sort="" if key is None else f"{key}") for shown, key in rest)]


SORT_SCRIPT = """
(function(){ document.querySelectorAll('table.sortable').forEach(table=>{
 const heads=[...table.querySelectorAll('thead th')], body=table.tBodies[0];
 heads.forEach((th,k)=>{ const button=document.createElement('button'); button.type='button';
  button.textContent=th.textContent; th.replaceChildren(button);
  button.onclick=()=>{ const falling=th.getAttribute('aria-sort')==='ascending';
   const value=row=>{ const v=row.cells[k].dataset.sort??'', x=Number(v); return v!==''&&!isNaN(x)?x:v; };
   const rows=[...body.rows].sort((a,b)=>{ const x=value(a), y=value(b);
    if(x===''||y==='') return (x==='')-(y==='');
    const order=typeof x==='number'&&typeof y==='number'?x-y:String(x).localeCompare(String(y));
    return falling?-order:order; });
   body.append(...rows);
   heads.forEach(other=>other.setAttribute('aria-sort',other!==th?'none':falling?'descending':'ascending')); }; });
 heads[0].setAttribute('aria-sort','ascending'); }); })();
"""
