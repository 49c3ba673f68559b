"""An export format of your own: JSON with the samples by column.

Use it:  smarig export RUN --to my_export_format -o run.json
"""

import json
from pathlib import Path

from smarig.record import AnyRun

COLUMNS = ("t_s", "current_A", "position")


def my_export_format(run: AnyRun, path: Path) -> None:
    """JSON: units, and the samples by column; null where nothing was measured."""
    columns = {name: [None if v != v else v for v in run[name].tolist()] for name in COLUMNS}
    units = {"t_s": "s", "current_A": "A", "position": run.unit}
    path.write_text(json.dumps({"units": units, "columns": columns}), encoding="utf-8")
