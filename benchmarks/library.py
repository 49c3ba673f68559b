"""The library of a folder of thousands of runs: opening, scanning, searching, and making it again."""

import tempfile
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

from smarig.console import Entry, Library
from smarig.record import write_run

RUNS = {True: 200, False: 5000}
WIRES, PROTOCOLS = 10, ("constant_force_cycles", "validation", "first_order_descending", "step_currents")
WITH_LOOPS = 10  # one run in so many has full loops, whose transformation temperatures are found
REPEATS = 5
PAGE = 1000
EPOCH, HOUR_S = 1_750_000_000.0, 3600.0
SEARCHES: dict[str, dict[str, Any]] = {
    "newest": {},
    "a word": {"text": "spool"},
    "words": {"text": "drift 7 validation"},
    "nothing": {"text": "no such words"},
    "tag": {"tags": ["good"]},
    "wire and verdict": {"wire": "spool 3", "verdict": "good", "order": "duration"},
    "dates": {"since": EPOCH + 100 * HOUR_S, "until": EPOCH + 900 * HOUR_S, "order": "name"},
    "last page": {"order": "oldest", "offset": 10**6},
}


def run(quick: bool = False, runs: int | None = None, seed: int = 0) -> dict[str, Any]:
    """``{"runs", "folder_MB", "first_scan_s", "open_s", "scan_unchanged_s", "search_s", "rebuild_equal", …}``.

    Times are those of a clock, the longest of several; ``first_scan_cpu_s`` is that of the processor.
    """
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        _make_runs(folder, runs or RUNS[quick], seed)
        size_MB = sum(file.stat().st_size for file in folder.rglob("*.run.sqlite")) / 1e6
        library = Library.open(folder)
        cpu_s, scanned = time.process_time(), _time(library.refresh)
        cpu_s = time.process_time() - cpu_s
        library.refresh()  # files of the last seconds once more
        _annotate(library)
        found = {
            "runs": library.search(kind="run").total,
            "folder_MB": round(size_MB, 1),
            "library_MB": round((folder / "library.sqlite").stat().st_size / 1e6, 1),
            "first_scan_s": scanned,
            "first_scan_cpu_s": round(cpu_s, 2),
            "open_s": _longest(lambda: Library.open(folder)),
            "scan_unchanged_s": _longest(library.refresh),
            "search_s": {name: _longest(_search(library, wanted)) for name, wanted in SEARCHES.items()},
            "facets_s": _longest(library.facets),
            "trends_s": _longest(lambda: library.trends("spool 3")),
        }
        before = _entries(library)
        found["rebuild_s"] = _time(library.rebuild)
        found["rebuild_equal"] = _entries(library) == before
    return found


def _make_runs(folder: Path, runs: int, seed: int) -> None:
    rng = np.random.default_rng(seed)
    for k in range(runs):
        u, y = _loop(full=k % WITH_LOOPS == 0)
        n = np.arange(u.size)
        meta = {
            "source": "bench",
            "protocol": PROTOCOLS[k % len(PROTOCOLS)],
            "rig": f"rig {k % 3}",
            "wire": f"spool {k % WIRES}",
            "start_epoch": EPOCH + k * HOUR_S,
            "seed": int(rng.integers(1000)),
            "settings": {"points": str(u.size)},
            "notes": f"drift {k % 17} of the clamp",
            "input": {"quantity": "wire temperature above ambient", "unit": "K"},
            "output": {"quantity": "displacement", "unit": "mm"},
        }
        columns = {"tick": n, "t_s": 0.1 * n, "input": u, "position": y + 0.002 * rng.standard_normal(u.size)}
        path = folder / f"week {k // 100}" / f"run {k}.run.sqlite"
        write_run(path, meta, columns, [], force=False)


def _loop(*, full: bool) -> tuple[np.ndarray, np.ndarray]:
    up = np.linspace(0.0, 100.0 if full else 50.0, 60)
    u = np.concatenate([up, up[::-1]])
    half = np.repeat([60.0, 40.0], up.size)
    return u, 5.0 / (1 + np.exp(-(u - half) / 4.0))


def _annotate(library: Library) -> None:
    for entry in library.search(limit=100, order="name").entries:
        library.tag(entry.id, ["good"], "benchmark")
        library.note(entry.id, "looked at", "benchmark")


def _search(library: Library, wanted: dict[str, Any]) -> Callable[[], object]:
    return lambda: library.search(**wanted)


def _entries(library: Library) -> list[Entry]:
    total = library.search(limit=0).total
    pages = (library.search(order="oldest", limit=PAGE, offset=k).entries for k in range(0, total, PAGE))
    return [entry for page in pages for entry in page]


def _longest(action: Callable[[], object]) -> float:
    return max(_time(action) for _ in range(REPEATS))


def _time(action: Callable[[], object]) -> float:
    began = time.perf_counter()
    action()
    return round(time.perf_counter() - began, 4)
