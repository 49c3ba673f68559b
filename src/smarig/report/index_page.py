"""The index page of a folder of runs: drawings on one scale and a table, which the reader can search and sort.

The drawings are SVG, so the page stays small with hundreds of runs.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from smarig.core import spaced
from smarig.report.components.comparison_labels import banner
from smarig.report.components.html import Html, bullets, cards, joined, notice, paragraph, tag
from smarig.report.components.numbers import duration, number, runs_text, thousands
from smarig.report.components.page import Section, page
from smarig.report.components.page_summary import FoundPage
from smarig.report.components.thumbnail import Frame, thumbnail
from smarig.report.runs.run_summary import RunSummary, shared_frames

_COLUMNS = (
    ("Run", "name"),
    ("Protocol", "protocol"),
    ("Rig", "rig"),
    ("Wire", "wire"),
    ("Source", "source"),
    ("Session start (UTC)", "began"),
    ("Seed", "seed"),
    ("Duration", "duration"),
    ("Steps settled", "settled"),
    ("Travel", "travel"),
    ("Marked", "marked"),
    ("Ended", "ended"),
)
_SEVERITY = {"bad": 0, "warning": 1, "good": 2}
_DOT_SHARE = 0.02  # of both axes: smaller loops are dots
_LONGEST = 220  # characters of a sentence on a card
_SORTS = (
    ("began", "time"),
    ("name", "name"),
    ("protocol", "protocol"),
    ("travel", "travel"),
    ("duration", "duration"),
)


@dataclass(frozen=True)
class IndexEntry:
    """A run's summary and the address of its page, relative to the index."""

    summary: RunSummary
    href: str


@dataclass(frozen=True)
class ResultEntry:
    """A page or a model with its summary, and its address relative to the index."""

    found: FoundPage
    href: str


def index_page(
    title: str,
    entries: Sequence[IndexEntry],
    unreadable: Sequence[str] = (),
    results: Sequence[ResultEntry] = (),
) -> str:
    """The HTML page of a folder: its runs, and the ``results`` (other pages, and models).

    ``unreadable`` gives the reason for each file that could not be read.
    """
    runs = [entry.summary for entry in entries]
    label, words = banner([run.label for run in runs])
    warning = notice("bad", paragraph(tag("b", "Not read")), bullets(unreadable)) if unreadable else Html("")
    table = joined(
        [tag("div", _table(entries), class_="table runs", tabindex=0), tag("script", Html(INDEX_SCRIPT))]
    )
    sections = [
        Section("Overview", "Overview", [_cards(runs), _search(runs)]),
        *_result_sections(results),
        Section("Hysteresis of every run", "Runs", [_gallery(entries), _caption(runs)]),
        Section("Every run in numbers", "Table", [table]),
    ]
    lead = "Search and sort the runs below. Each name links to the page of its run."
    return page(title, lead, sections, label=label, simulated=words, notices=[warning])


def _result_sections(results: Sequence[ResultEntry]) -> list[Section]:
    """Pages of results, the most serious first, then models."""
    models = [each for each in results if each.found.summary.kind == "model"]
    pages = [each for each in results if each not in models]
    pages.sort(key=lambda each: _SEVERITY.get(each.found.summary.level, 3))
    named = (
        ("Results", pages, "Each name links to its page."),
        ("Models", models, "Each name links to its file."),
    )
    return [
        Section(title, title, [tag("ul", *map(_result_card, each), class_="gallery"), paragraph(words)])
        for title, each, words in named
        if each
    ]


def _result_card(entry: ResultEntry) -> Html:
    about = entry.found.summary
    drawn = thumbnail(about.u, about.y, f"Loop of {entry.found.title}.", about.units, about.label)
    sentence = (
        about.sentence
        if len(about.sentence) <= _LONGEST
        else about.sentence[:_LONGEST].rsplit(" ", 1)[0] + " …"
    )
    text = f"{entry.found.title} {entry.found.path.name} {about.kind} {about.sentence}".lower()
    classes = ["twinned"] * bool(about.label) + ["level", about.level] * bool(about.level)
    return tag(
        "li",
        drawn,
        tag("a", entry.found.title, href=entry.href),
        tag("p", tag("b", about.kind), ". ", sentence),
        data_words=text,
        class_=" ".join(classes),
    )


def _cards(runs: Sequence[RunSummary]) -> Html:
    ending_text = sum(run.cause == "done" for run in runs)
    flagged = sum(run.flagged > 0 for run in runs)
    marked = f"{runs_text(flagged)} with marked samples" if flagged else "no marked samples"
    return cards(
        [
            (
                "Runs",
                thousands(len(runs)),
                f"{ending_text} ended as planned, {len(runs) - ending_text} did not",
            ),
            ("Rig time", duration(float(np.nansum([run.duration_s for run in runs]))), "sum of all runs"),
            ("Samples", thousands(sum(run.samples for run in runs)), marked),
            *_wires_card(runs),
        ]
    )


def _wires_card(runs: Sequence[RunSummary]) -> list[tuple[str, str, str]]:
    """The number of wires; none if no run names its wire, as imported ones usually do not."""
    wires = {(run.rig, run.wire) for run in runs if run.wire}
    unnamed = sum(not run.wire for run in runs)
    if not wires:
        return []
    also = f"; {runs_text(unnamed)} of unnamed wires" if unnamed else ""
    return [("Wires", str(len(wires)), f"distinct pairs of rig and wire{also}")]


# --- controls -------------------------------------------------------------------------------------------


def _search(runs: Sequence[RunSummary]) -> Html:
    found = tag(
        "input", type="search", name_="words", autocomplete="off", placeholder="name, protocol, seed, note…"
    )
    return tag(
        "form",
        tag("label", "Search", found),
        _filter_select("Protocol", "protocol", [run.protocol for run in runs]),
        _filter_select("Rig", "rig", [run.rig for run in runs]),
        _filter_select("Ended", "ended", [_ending_text(run) for run in runs]),
        tag("label", "Sort by", tag("select", *(tag("option", w, value=k) for k, w in _SORTS), name_="sort")),
        tag("button", "Reverse", type="button", name_="falling", aria_pressed="false"),
        tag("span", role="status"),
        class_="search",
        role="search",
        hidden="hidden",
    )


def _filter_select(words: str, name: str, values: Sequence[str]) -> Html:
    known = sorted({value for value in values if value})
    options = [Html('<option value="">all</option>'), *(tag("option", value, value=value) for value in known)]
    return tag("label", words, tag("select", *options, name_=name))


def _ending_text(run: RunSummary) -> str:
    return "as planned" if run.cause == "done" else "otherwise"


# --- pictures and table ---------------------------------------------------------------------------------


def _gallery(entries: Sequence[IndexEntry]) -> Html:
    frames = shared_frames([entry.summary for entry in entries])
    items = []
    for k, (entry, frame) in enumerate(zip(entries, frames)):
        run = entry.summary
        drawn = run.drawing(frame) if run.u.size else paragraph("Nothing to draw.")
        if frame is not None and _is_still(run, frame):
            drawn = paragraph(_still_text(run))
        ending = [] if run.cause == "done" else [tag("p", tag("b", run.cause))]
        name = tag("a", _run_stem(run), href=entry.href)
        about = tag("p", f"{run.protocol}; {run.size}")
        items.append(
            tag("li", drawn, name, about, *ending, data_run=str(k), class_="twinned" if run.label else "")
        )
    return tag("ul", *items, class_="gallery")


def _is_still(run: RunSummary, frame: Frame) -> bool:
    """Whether a loop is no more than a dot in its frame, as that of a cold wire that is initialised."""
    return all(
        np.ptp(values) < _DOT_SHARE * (ends[1] - ends[0])
        for values, ends in ((run.u, frame.u), (run.y, frame.y))
    )


def _still_text(run: RunSummary) -> str:
    moved = [
        f"{name} {number(float(np.ptp(values)), 2)}{spaced(unit)}"
        for name, values, unit in (("input", run.u, run.input_unit), ("output", run.y, run.unit))
    ]
    return f"No loop: input and output hardly change (ranges: {', '.join(moved)})."


def _caption(runs: Sequence[RunSummary]) -> Html:
    families = len({run.scale_group for run in runs})
    scale = "All runs are" if families == 1 else "Runs of one rig, wire and unit are"
    return paragraph(
        f"Output against hysteresis input along the path of the samples: vermilion rising, blue falling. "
        f"{scale} drawn on one scale. Each output axis begins at the minimum of its run, because every session has its "
        "own zero."
    )


def _table(entries: Sequence[IndexEntry]) -> Html:
    heads = [tag("th", words, scope="col", data_key=key) for words, key in _COLUMNS]
    rows = [_row(k, entry) for k, entry in enumerate(entries)]
    title = tag(
        "caption", "Runs. Marked: steps that did not settle or are void, and samples with a quality mark."
    )
    return tag("table", title, tag("thead", tag("tr", *heads)), tag("tbody", *rows))


def _row(k: int, entry: IndexEntry) -> Html:
    run = entry.summary
    settled = f"{run.settled} of {run.steps}" if run.steps else ""
    travel = f"{number(run.travel)}{spaced(run.unit)}"
    took = duration(run.duration_s) if np.isfinite(run.duration_s) else ""
    ending_text = run.cause if run.cause == "done" else tag("b", run.cause)
    cells = (
        run.protocol,
        run.rig,
        run.wire,
        run.source,
        run.began,
        run.seed,
        took,
        settled,
        travel,
        run.flagged,
        ending_text,
    )
    text = (run.file, *map(str, cells[:6]), run.cause, run.notes, run.settings)
    return tag(
        "tr",
        tag("th", tag("a", _run_stem(run), href=entry.href), scope="row"),
        *(tag("td", cell) for cell in cells),
        data_run=str(k),
        data_text=" ".join(text).lower(),
        data_ended=_ending_text(run),
        **_sort_attributes(run),
    )


def _sort_attributes(run: RunSummary) -> dict[str, str]:
    """The sort keys of a row, one per column; numbers without units."""
    sizes = {"duration": run.duration_s, "travel": run.travel}
    plain = {
        "name": run.file,
        "protocol": run.protocol,
        "rig": run.rig,
        "wire": run.wire,
        "source": run.source,
    }
    plain |= {"began": run.began, "seed": run.seed, "settled": str(run.settled), "marked": str(run.flagged)}
    plain |= {key: f"{value:.6g}" if np.isfinite(value) else "" for key, value in sizes.items()}
    return {f"data_{key}": value for key, value in plain.items()}


def _run_stem(run: RunSummary) -> str:
    return run.file.removesuffix(".sqlite").removesuffix(".run")


INDEX_SCRIPT = """
(function(){
 const rows=[...document.querySelectorAll('tbody tr[data-run]')];
 const cards=rows.map(row=>document.querySelector('li[data-run="'+row.dataset.run+'"]'));
 const form=document.querySelector('.search'), status=form.querySelector('[role=status]');
 const heads=[...document.querySelectorAll('th[data-key]')];
 let key='began', falling=false;
 form.hidden=false;
 function show(){
  const words=form.words.value.toLowerCase().split(/\\s+/).filter(Boolean);
  const wanted=['protocol','rig','ended'].map(name=>[name,form[name].value]);
  let n=0;
  rows.forEach((row,k)=>{
   const hit=words.every(w=>row.dataset.text.includes(w))&&wanted.every(([name,v])=>!v||row.dataset[name]===v);
   row.hidden=cards[k].hidden=!hit; n+=hit;
  });
  document.querySelectorAll('li[data-words]').forEach(one=>{
   one.hidden=!words.every(w=>one.dataset.words.includes(w)); });
  status.textContent=n+' of '+rows.length+(rows.length===1?' run':' runs');
 }
 function value(row){ const v=row.dataset[key]??'', x=Number(v); return v!==''&&!isNaN(x)?x:v; }
 function compare(a,b){
  const x=value(rows[a]), y=value(rows[b]);
  if(x===y) return a-b;
  if(x==='') return 1; if(y==='') return -1;
  const less=typeof x==='number'&&typeof y==='number'?x<y:String(x).localeCompare(String(y),undefined,{numeric:true})<0;
  return less!==falling?-1:1;
 }
 function order(){
  const sorted=rows.map((_,k)=>k).sort(compare);
  const body=rows.length&&rows[0].parentNode, list=cards.length&&cards[0].parentNode;
  sorted.forEach(k=>{ body.append(rows[k]); list.append(cards[k]); });
  heads.forEach(th=>th.setAttribute('aria-sort',th.dataset.key!==key?'none':falling?'descending':'ascending'));
  form.sort.value=key; form.falling.setAttribute('aria-pressed',falling);
 }
 heads.forEach(th=>{ const button=document.createElement('button'); button.type='button';
  button.textContent=th.textContent; th.replaceChildren(button);
  button.onclick=()=>{ falling=key===th.dataset.key&&!falling; key=th.dataset.key; order(); }; });
 form.sort.onchange=()=>{ key=form.sort.value; order(); };
 form.falling.onclick=()=>{ falling=!falling; order(); };
 form.oninput=show;
 form.onsubmit=event=>event.preventDefault();
 order(); show();
})();
"""
