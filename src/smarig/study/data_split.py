"""Splits the runs of a study into those that a model is fitted to and those that it is judged on."""

import hashlib
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from smarig.core import UsageError
from smarig.measurement import CONTINUES_AT, PART_OF, cycles_before, dropouts, full_cycles_before
from smarig.record import CONTINUED, FORC_PROTOCOL, Run, load_run, write_run
from smarig.replay import recorded_conditions
from smarig.study.imported_runs import ImportedTable
from smarig.study.input_turns import wide_turns
from smarig.study.study_options import Split

LOAD = "stress"
_TRAIN_SHARE = 0.6  # of the branches, for a split in time
_FEWEST_BRANCHES = 4
_MOVES = 0.5  # of the range of the output: a part with less shows no transformation
_HELD_SHARE = 3  # one of so many runs is held out
_EVEN, _ODD = "curve%2==0", "curve%2==1"


@dataclass(frozen=True, eq=False)
class DataSplit:
    """Training and held-out runs; ``select`` are expressions that choose curves of the same runs for each.

    ``before``: the held-out runs continue the training runs. ``reason`` is a sentence.
    """

    kind: Split
    reason: str
    train: tuple[Run, ...]
    held_out: tuple[Run, ...]
    select: tuple[str, str] | None = None
    continued: bool = False


def split_runs(tables: Sequence[ImportedTable], wanted: Split, folder: Path) -> DataSplit:
    """The split of the runs. Raises UsageError if the wanted one cannot be made.

    ``folder`` takes the files of the parts of a run that is split.
    """
    runs = [table.run for table in tables]
    kind = _usual(runs) if wanted == "auto" else wanted
    named = "" if wanted == "auto" else " (as requested)"
    match kind:
        case "curve":
            return _by_curve(runs, folder, named)
        case "load":
            return _by_load(runs, named)
        case "run":
            return _by_run(runs, named)
        case "time":
            return _by_time(runs, folder, named)
        case _:
            return _without_split(runs, named)


def _usual(runs: Sequence[Run]) -> Split:
    """The split that data of this kind allow."""
    if any(run.info.protocol == FORC_PROTOCOL for run in runs) or (len(runs) == 1 and _loops(runs[0]) >= 3):
        return "curve"
    if len(_loads(runs)) >= 3:
        return "load"
    if len(runs) >= 2:
        return "run"
    return "time" if runs[0].has("position") and _time_cut(runs[0]) is not None else "none"


def _without_split(runs: Sequence[Run], named: str) -> DataSplit:
    reason = "Nothing is held out" + (
        named
        or ": one loop at most, and a part of it does not show what the rest does. Errors are those of the fit."
    )
    return DataSplit("none", reason, tuple(runs), ())


def _by_curve(runs: Sequence[Run], folder: Path, named: str) -> DataSplit:
    if all(run.info.protocol == FORC_PROTOCOL for run in runs):
        reason = f"Every second reversal curve is held out{named}: the fit has not seen it."
        return DataSplit("curve", reason, tuple(runs), tuple(runs), (_EVEN, _ODD))
    if len(runs) != 1 or _loops(runs[0]) < 3:
        raise UsageError(
            "--split curve needs reversal curves, or a run of at least three loops. Leave it out."
        )
    run = runs[0]
    number = np.nan_to_num(run["step"], nan=-1.0)
    loops = np.unique(number)
    held = loops[1:-1:2] if loops.size < 5 else loops[1:-1][1::2]
    mask = np.isin(number, held)
    parts = [_part(run, rows, folder, title) for rows, title in ((~mask, "fitted"), (mask, "held_out"))]
    reason = (
        f"{held.size} of {loops.size} loops are held out{named}, none of them the smallest or the largest."
    )
    return DataSplit("curve", reason, (parts[0],), (parts[1],))


def _by_load(runs: Sequence[Run], named: str) -> DataSplit:
    loads = _loads(runs)
    if len(loads) < 3:
        raise UsageError(
            f"--split load needs runs at three or more loads; these have {len(loads)}. Leave it out."
        )
    values = sorted(loads)
    middle = values[len(values) // 2]
    held = loads[middle]
    rest = tuple(run for value in values if value != middle for run in loads[value])
    reason = (
        f"The load of {middle:.4g} MPa, between the others, is held out{named}: the model must predict it."
    )
    return DataSplit("load", reason, rest, tuple(held))


def _by_run(runs: Sequence[Run], named: str) -> DataSplit:
    if len(runs) < 2:
        raise UsageError("--split run needs at least two runs. Give several files, or leave it out.")
    count = max(len(runs) // _HELD_SHARE, 1)
    which = "The last run is" if count == 1 else f"The last {count} of {len(runs)} runs are"
    held = f"{which} held out{named}"
    return DataSplit(
        "run", f"{held}: a model must predict another run.", tuple(runs[:-count]), tuple(runs[-count:])
    )


def _by_time(runs: Sequence[Run], folder: Path, named: str) -> DataSplit:
    if len(runs) != 1:
        raise UsageError("--split time divides one run; these are several. Use --split run.")
    run = runs[0]
    turns = _turns(run)
    if turns.size <= _FEWEST_BRANCHES:
        raise UsageError(
            f"--split time needs at least {_FEWEST_BRANCHES} branches; this run has {turns.size - 1}. Leave it out."
        )
    cut = _time_cut(run) or _usual_cut(turns)
    rows = np.arange(len(run))
    first, second = (
        _part(run, rows < cut, folder, "first"),
        _part(run, rows >= cut, folder, "second", after=True),
    )
    share = f"{100 * cut / len(run):.0f} %"
    reason = f"The first {share} of the run is fitted, and the rest, which comes later, is held out{named}."
    return DataSplit("time", reason, (first,), (second,), continued=True)


def _usual_cut(turns: np.ndarray) -> int:
    return int(turns[max(2, round(_TRAIN_SHARE * (turns.size - 1)))])


def _time_cut(run: Run) -> int | None:
    """The row of the turn at which a run is split, at most 60 % of its branches before it; None if no part would do.

    Both parts must show the output move: a cold end alone tests nothing.
    """
    turns = _turns(run)
    if turns.size <= _FEWEST_BRANCHES:
        return None
    y = run["position"]
    cuts = [int(turn) for turn in turns[2:] if turn <= _usual_cut(turns)]
    return next(
        (cut for cut in reversed(cuts) if min(_range(y[:cut]), _range(y[cut:])) >= _MOVES * _range(y)), None
    )


def _range(y: np.ndarray) -> float:
    known = y[np.isfinite(y)]
    return float(np.ptp(known)) if known.size else 0.0


def _turns(run: Run) -> np.ndarray:
    """Rows at which the input turns, with both ends."""
    if run.settled:
        return np.zeros(1, dtype=int)
    known = np.flatnonzero(np.isfinite(run["input"]) & np.isfinite(run["position"]))
    known = known[~dropouts(run["input"][known])]  # each would look like two branches
    return known[wide_turns(run["input"][known])] if known.size > 3 else np.zeros(1, dtype=int)


def _loops(run: Run) -> int:
    """Number of loops that a run without steps numbers."""
    if run.steps or run.has("t_s"):
        return 0
    return np.unique(run["step"][np.isfinite(run["step"])]).size


def _loads(runs: Sequence[Run]) -> dict[float, list[Run]]:
    """The runs by the load that they state, rounded to three digits; empty if one states none."""
    found: dict[float, list[Run]] = {}
    for run in runs:
        load = recorded_conditions(run).get(LOAD)
        if load is None or isinstance(load.value, str):
            return {}
        value = float(f"{float(load.value):.2g}")
        found.setdefault(value, []).append(run)
    return found


def _part(run: Run, rows: np.ndarray, folder: Path, title: str, *, after: bool = False) -> Run:
    """A part of a run as a run of its own; ``after``: it continues the part "first"."""
    path = folder / "runs" / f"{run.path.name.removesuffix('.run.sqlite')}_{title}.run.sqlite"
    imported = dict(run.meta.get("imported") or {})
    whole = str(imported.get("sha256", ""))
    imported |= {"sha256": _hash(whole, title), PART_OF: run.name}
    meta = {key: value for key, value in run.meta.items() if key not in ("schema_version", "end", "hashes")}
    meta["notes"] = f"Part '{title}' of {run.path.name}. {meta.get('notes', '')}".strip()
    if after:
        imported |= {"continues": f"{title}.run.sqlite", "continues_sha256": _hash(whole, "first")}
        imported[CONTINUES_AT] = _so_far(run, rows)
        meta["initial"] = CONTINUED
    columns = {name: values[rows] for name, values in run.columns.items() if run.has(name)}
    columns["tick"] = np.arange(int(rows.sum()), dtype=float)
    columns["quality"] = np.nan_to_num(run["quality"][rows])
    write_run(path, meta | {"imported": imported}, columns, [], force=True)
    return load_run(path)


def _so_far(run: Run, rows: np.ndarray) -> dict[str, float]:
    """When a run began, and its cycles before the part with these rows: clocks and counts go on over a split."""
    before = run["input"][np.isfinite(run["input"]) & ~rows]
    travel = full_cycles_before(before)[1]
    found = {"cycles": float(cycles_before(before)[-1]) if before.size else 0.0} | travel._asdict()
    return found | ({"began_s": float(run["t_s"][0])} if run.has("t_s") else {})


def _hash(whole: str, title: str) -> str:
    return hashlib.sha256(f"{whole} {title}".encode()).hexdigest()
