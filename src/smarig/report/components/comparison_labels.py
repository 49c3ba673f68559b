"""Parts of all comparison pages: distinct names, the largest number of items, and the banner."""

from collections.abc import Sequence
from pathlib import Path

from smarig.core import UsageError
from smarig.report.components.page import SIMULATED_TEXT
from smarig.report.components.style import COMPARED


def distinct_names(files: Sequence[Path], ending: str) -> list[str]:
    """Short distinct names of files: without their ending, with as many folders as needed. The same file of the same
    folder of several campaigns has the name of the campaign.

    >>> distinct_names([Path("a/x.run.sqlite"), Path("b/x.run.sqlite"), Path("b/y.run.sqlite")], ".run.sqlite")
    ['a/x', 'b/x', 'y']
    >>> distinct_names([Path("day 1/runs/x.run.sqlite"), Path("day 2/runs/x.run.sqlite")], ".run.sqlite")
    ['day 1', 'day 2']
    """
    parts = [(*file.parts[:-1], file.name.removesuffix(ending)) for file in files]
    ends = {part[-2:] for part in parts}
    if len(parts) > 1 and len(ends) == 1 and all(len(part) > 2 for part in parts):
        parts = [part[:-2] for part in parts]
    named = []
    for k, mine in enumerate(parts):
        others = parts[:k] + parts[k + 1 :]
        depth = next((d for d in range(1, len(mine)) if all(o[-d:] != mine[-d:] for o in others)), len(mine))
        named.append("/".join(mine[-depth:]))
    return named


def check_comparable_count(things: Sequence[object], kind: str) -> None:
    """Raise UsageError if there are more items than distinguishable colours."""
    if len(things) > len(COMPARED):
        raise UsageError(
            f"{len(things)} {kind} cannot be distinguished in one figure. Compare at most {len(COMPARED)}."
        )


def banner(labels: Sequence[str]) -> tuple[str, str]:
    """The banner's label and its sentence, from the labels of all runs.

    >>> banner(["TWIN", "", ""])
    ('TWIN', '1 of the 3 runs on this page come from a software simulation.')
    """
    simulated = [label for label in labels if label]
    some = f"{len(simulated)} of the {len(labels)} runs on this page come from a software simulation."
    return "".join(simulated[:1]), SIMULATED_TEXT if len(simulated) == len(labels) else some
