"""The page that compares the studies of many files."""

from collections import Counter
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from smarig.report import Html, Section, bullets, cards, display_unit, number, page, paragraph, tag
from smarig.report import table as html_table

if TYPE_CHECKING:
    from smarig.study.each_file import FileOutcome

_ORDER = {"poor": 0, "fair": 1, "good": 2, None: 3}


def studies_page(outcomes: "Sequence[FileOutcome]", name: str) -> str:
    """The HTML page: how many models are good, a row for each file (the worst first), and the files that failed."""
    done = [o for o in outcomes if o.found is not None]
    failed = [o for o in outcomes if o.failed]
    left_out = [o for o in outcomes if o.left_out]
    verdicts = Counter(o.found["verdict"] for o in done if o.found)
    items = [(word.capitalize(), str(verdicts[word]), "models") for word in ("good", "fair", "poor")]
    items += [("Without an output", str(verdicts[None]), "files"), ("Failed", str(len(failed)), "files")]
    rows = [_row(o.found, Path(o.folder).name) for o in sorted(done, key=_rank) if o.found]
    head = (
        "File",
        "Verdict",
        "Split",
        "rms",
        "Unit",
        "% of range",
        "× noise",
        "Best simple curve",
        "Diagnosis",
        "Runs",
    )
    sections = [
        Section(
            "Result",
            "Result",
            [cards(items), html_table(head, rows, "The worst first.") if rows else paragraph("None.")],
        )
    ]
    if failed:
        sections.append(
            Section("Files that failed", "Failed", [bullets([f"{o.file}: {o.failure}" for o in failed])])
        )
    if left_out:
        files = bullets([f"{o.file}: {o.left_out}" for o in left_out])
        sections.append(Section("Files that are no data", "Left out", [files], folded=True))
    lead = f"{len(done)} of {len(done) + len(failed)} files were studied, each on its own page"
    return page(f"Studies of {name}", lead, sections)


def _rank(outcome: "FileOutcome") -> tuple[int, float]:
    found: dict[str, Any] = outcome.found or {}
    held = found.get("held_out") or {}
    return _ORDER.get(found.get("verdict"), 3), -float(held.get("nrmse") or 0.0)


def _row(found: dict[str, Any], folder: str) -> list[Html | str]:
    held, split = found.get("held_out") or {}, found.get("split") or {}
    noise = held.get("noise_floor")
    simple = min((found.get("simple_curves") or {}).values(), default=None)
    return [
        tag("a", folder, href=f"{folder}/index.html"),
        found.get("verdict") or "heating only",
        split.get("kind", ""),
        number(held.get("rms")),
        display_unit(found.get("unit") or ""),
        number(100 * held["nrmse"], 2) if held.get("nrmse") is not None else "–",
        number(held["rms"] / noise, 2) if noise and held.get("rms") is not None else "–",
        number(simple),
        (found.get("diagnosis") or {}).get("verdict", "–"),
        str(len(found.get("runs", ()))),
    ]
