"""Memory and processor time of long runs, large files and large folders: a day at 10 Hz, three million rows, 500 runs.

Each command runs in a process of its own, of which the largest resident memory and the processor time are measured.
Memory that grows with the data is given per row: the difference to the same command on small data.
"""

import json
import shutil
import subprocess
import sys
import tempfile
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from smarig.record import stored_run

RIG = "one_wire_twin"
HOLD_S = 150.0  # of a step with a settle window of WINDOW_S
WINDOW_S = 105.0
FORMATS = ("csv", "parquet", "netcdf", "mat", "rrd")
MEASURE = """
import json, os, subprocess, sys
child = subprocess.Popen(sys.argv[1:], stdout=subprocess.DEVNULL, stderr=subprocess.PIPE)
said = child.stderr.read().decode(errors="replace")
_, status, used = os.wait4(child.pid, 0)
most = used.ru_maxrss / (1e6 if sys.platform == "darwin" else 1e3)
print(json.dumps({"status": os.waitstatus_to_exitcode(status), "said": said[-500:], "rss_MB": most,
                  "cpu_s": used.ru_utime + used.ru_stime}))
"""  # in a small process of its own: the memory of a parent counts as its child's


@dataclass(frozen=True)
class _Size:
    hours: float
    rows: int
    runs: int


SMALL = _Size(0.1, 10_000, 2)
SIZES = {True: _Size(1.0, 100_000, 20), False: _Size(24.0, 3_000_000, 500)}


def run(quick: bool = False) -> dict[str, Any]:
    """``{"floor": {"rss_MB", "cpu_s"}, "run": {"rows", "rss_MB", "cpu_s", "bytes_per_row"}, "report", "export", …}``.

    ``floor`` is Python with numpy.
    """
    with tempfile.TemporaryDirectory() as folder:
        small = _figures(Path(folder) / "small", SMALL)
        large = _figures(Path(folder) / "large", SIZES[quick])
    return {"floor": _measured(sys.executable, "-c", "import numpy"), **_with_growth(small, large)}


def _figures(folder: Path, size: _Size) -> dict[str, Any]:
    folder.mkdir()
    day, table = folder / "day.run.sqlite", folder / "table.csv"
    levels = [round(0.1 + 0.0075 * (37 * k % 100), 4) for k in range(round(3600 * size.hours / HOLD_S))]
    profile = ["--set", f"currents_A={','.join(map(str, levels))}", "--set", f"settle.window_s={WINDOW_S}"]
    found: dict[str, Any] = {"run": _smarig("run", "step_currents", "--rig", RIG, *profile, "-o", day)}
    with stored_run(day) as stored:
        rows = len(stored)
    found["report"] = _smarig("report", day, "-o", folder / "day.html")
    for to in FORMATS:
        found[f"export {to}"] = _smarig("export", day, "--to", to, "-o", folder / f"day.{to}")
    for figures in found.values():
        figures["rows"] = rows
    _write_table(table, size.rows)
    found["import"] = {
        **_smarig("import", table, "--format", "csv", "-o", folder / "t.run.sqlite"),
        "rows": size.rows,
    }
    return found | _index_figures(folder / "runs", size.runs)


def _index_figures(folder: Path, runs: int) -> dict[str, Any]:
    """An index with the pages of all runs, an index where the pages are there, and once more without a change."""
    folder.mkdir()
    first = folder / "0.run.sqlite"
    _smarig("run", "validation", "--rig", RIG, "--set", "points=5", "-o", first)
    for k in range(1, runs):
        shutil.copy(first, folder / f"{k}.run.sqlite")
    found = {"pages and index": _smarig("report", folder)}
    (folder / "smarig-index.json").unlink()
    found["index"] = _smarig("report", folder)
    found["index again"] = _smarig("report", folder)
    return {kind: {**figures, "runs": runs} for kind, figures in found.items()}


def _with_growth(small: dict[str, Any], large: dict[str, Any]) -> dict[str, Any]:
    for kind, figures in large.items():
        if "rows" in figures and "rss_MB" in figures:
            growth = 1e6 * (figures["rss_MB"] - small[kind]["rss_MB"])
            figures["bytes_per_row"] = round(growth / (figures["rows"] - small[kind]["rows"]), 1)
    return large


def _smarig(*arguments: Any) -> dict[str, Any]:
    return _measured(sys.executable, "-m", "smarig", *map(str, arguments))


def _measured(*command: str) -> dict[str, Any]:
    """Memory and time of a command; ``{"said"}`` if it fails, for example without an extra."""
    outer = [sys.executable, "-S", "-c", MEASURE, *command]
    made = json.loads(subprocess.run(outer, capture_output=True, check=True).stdout)
    if made["status"] != 0:
        return {"said": made["said"].strip()}
    return {key: round(made[key], 2) for key in ("rss_MB", "cpu_s")}


def _write_table(path: Path, rows: int) -> None:
    rng = np.random.default_rng(1)
    with path.open("w", encoding="utf-8") as file:
        file.write("time_s,current_command_A,current_A,voltage_V,position_mm,ambient_degC\n")
        for a in range(0, rows, 100_000):
            k = np.arange(a, min(a + 100_000, rows))
            command = 0.0003 * (7919 * (k // 3000) % 3000)
            noise = rng.normal(size=(3, k.size))
            columns = (
                0.1 * k,
                command,
                command + 1e-4 * noise[0],
                4 * command + 1e-3 * noise[1],
                8 * np.sin(k / 9000) + 2e-3 * noise[2],
                np.full(k.size, 22.5),
            )
            cells = (np.round(column, 4).tolist() for column in columns)
            file.writelines(",".join(map(repr, row)) + "\n" for row in zip(*cells, strict=True))
