"""Diagnoses of measurements by others whose causes are known, or known to be none.

The data lie in ``shared/data`` beside the repository and are no part of it. A name counts as false if the cause is
not known; an extended model that is worse on held-out runs counts as worse.
"""

import contextlib
import io
import tempfile
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from smarig.core import UsageError
from smarig.diagnosis import MeasuredDiagnosis, diagnose
from smarig.exchange import import_file
from smarig.identification import identify, verify
from smarig.record import Run, load_run

DATA = Path(__file__).resolve().parents[2] / "shared" / "data"


@dataclass(frozen=True)
class RealCase:
    """Training and held-out files of one set, the mapping, and what is known.

    ``names`` are the right effects, ``variables`` the right answers of an unknown verdict; both empty if any name is
    false. A file is (path in the data folder, mapping or "" for a FORC file).
    """

    name: str
    train: tuple[tuple[str, str], ...]
    held_out: tuple[tuple[str, str], ...] = ()
    names: tuple[str, ...] = ()
    variables: tuple[str, ...] = ()


def _files(pattern: str, keys: Sequence[Any], mapping: str) -> tuple[tuple[str, str], ...]:
    return tuple((pattern.format(key), mapping) for key in keys)


WATER = "sma_water_steps/hyd_stp_{}.txt", "sma_water_steps"
FLEXINOL = "flexinol_isobaric/filtered_data_{}MPa.txt", "flexinol_isobaric"
ISOBARIC = "sma_isobaric/cal_sample_2/{} MPa.txt", "sma_isobaric_2"
FORCE = "sma_force_runs/AB{}_thin.csv", "sma_force_runs"
FERROELECTRIC = "ferroelectric_loops/RMN_TRAP_SLOW.dat"
STRESSES = (7, 50, 100, 200, 300, 400)


def _of(source: tuple[str, str], *keys: Any) -> tuple[tuple[str, str], ...]:
    return _files(source[0], keys, source[1])


CASES = (
    RealCase("water 1 → 2, 3", _of(WATER, 1), _of(WATER, 2, 3), ("input_lag",)),
    RealCase("water 1, 2 → 3", _of(WATER, 1, 2), _of(WATER, 3), ("input_lag",)),
    RealCase("flexinol 50, 100 → 150", _of(FLEXINOL, 50, 100), _of(FLEXINOL, 150), ("stress_shift",)),
    RealCase("flexinol 50, 150 → 100", _of(FLEXINOL, 50, 150), _of(FLEXINOL, 100), ("stress_shift",)),
    RealCase("isobaric, six stresses", _of(ISOBARIC, *STRESSES), (), ("stress_shift",)),
    *(
        RealCase(
            f"isobaric without {left_out}",
            _of(ISOBARIC, *(s for s in STRESSES if s != left_out)),
            _of(ISOBARIC, left_out),
            ("stress_shift",),
        )
        for left_out in (100, 200, 300)
    ),
    RealCase("force AB5 → AB7", _of(FORCE, 5), _of(FORCE, 7), ("input_offset",), ("run",)),
    RealCase("cycles", (("sma_cycles/cycles.txt", "sma_cycles"),), (), ("ratcheting",), ("cycle",)),
    RealCase(
        "ferroelectric, slow and fast",
        ((FERROELECTRIC, "ferroelectric_loops:1"), (FERROELECTRIC, "ferroelectric_loops:2")),
        ((FERROELECTRIC, "ferroelectric_loops:6"),),
        (),
        ("rate",),
    ),
    RealCase("chamber 100 MPa", (("sma_chamber/chamber_100MPa.csv", "sma_chamber"),)),
    RealCase("forc MSM33", (("forc_magnetic/MSM33-55-1_d330.forc", ""),)),
    RealCase("forc UB199BF", (("forc_magnetic/UB199BF", ""),)),
    RealCase("forc hchb", (("forc_magnetic/hchb_forc", ""),)),
)
QUICK = ("water 1 → 2, 3", "flexinol 50, 100 → 150", "force AB5 → AB7", "forc MSM33")


def run(quick: bool = False) -> dict[str, Any]:
    """Each case with its verdict and errors, and the numbers of right, false and missed causes."""
    if not DATA.is_dir():
        raise UsageError(
            f"This benchmark needs measurements by others in {DATA.parent.name}/{DATA.name} beside the repository."
        )
    cases = [case for case in CASES if not quick or case.name in QUICK]
    with tempfile.TemporaryDirectory() as folder:
        found = {case.name: row for case in cases for row in _row(case, Path(folder))}
    outcomes = [row["outcome"] for row in found.values()]
    return {
        "right": outcomes.count("right"),
        "false_names": outcomes.count("false name"),
        "missed": outcomes.count("missed"),
        "worse_on_held_out": sum(row["worse"] for row in found.values()),
        "cases": found,
    }


def _row(case: RealCase, folder: Path) -> Iterator[dict[str, Any]]:
    train, held_out = ([_imported(f, folder) for f in files] for files in (case.train, case.held_out))
    surface = "positive" if case.train[0][1] else "table"
    model = identify(train[:1], surface).model
    d = diagnose(model, train, held_out)
    if not isinstance(d, MeasuredDiagnosis):
        return
    answer = d.to_json()
    yield {
        "outcome": _outcome(case, d),
        "verdict": answer["verdict"],
        "effects": {
            e["name"]: {k: v["value"] for k, v in e["parameters"].items()} for e in answer["effects"]
        },
        "depends_on": answer["depends_on"],
        "rms": {key: answer["error"][key] for key in ("base", "extended", "noise_floor")},
        "held_out": answer["held_out"] and {k: answer["held_out"][k] for k in ("given", "base", "extended")},
        "nrmse": _nrmse(d, held_out or train),
        "offsets": {o["run"]: o["offset"] for o in answer["run_offsets"]},
        "worse": bool(d.gain is not None and d.extended and d.gain.extended > d.gain.base),
        "seconds": round(d.seconds, 1),
    }


def _outcome(case: RealCase, d: MeasuredDiagnosis) -> str:
    named = set(d.verdict.names) if d.extended else set()
    if named - set(case.names):
        return "false name"
    if named or d.verdict.depends_on in case.variables:
        return "right"
    known = case.names or case.variables
    return "missed" if known else "right"


def _nrmse(d: MeasuredDiagnosis, runs: Sequence[Run]) -> dict[str, float]:
    """Errors of the extended model at all rows, over the range of the output; empty if there is none."""
    if not d.extended:
        return {}
    return {Path(r.run).name.split(".")[0]: round(r.settled.nrmse, 4) for r in verify(d.model, runs).runs}


def _imported(file: tuple[str, str], folder: Path) -> Run:
    path, mapping = file
    name = f"{path}{mapping}".replace("/", "_").replace(" ", "_").replace(":", "_").replace(".", "_")
    out = folder / f"{name}.run.sqlite"
    if not out.exists():
        with contextlib.redirect_stderr(io.StringIO()):
            import_file(DATA / path, format="csv" if mapping else "forc", out=out, mapping=mapping or None)
    return load_run(out)
