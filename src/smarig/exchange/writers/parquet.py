"""A run's samples as Parquet; units, description, steps and events in the schema's metadata."""

import json
from dataclasses import asdict
from pathlib import Path

import numpy as np

from smarig.errors import UsageError
from smarig.record import Run
from smarig.record.schema import SAMPLE_COLUMNS

_INTEGERS = ("tick", "step", "counts", "quality")
_UNITS = {
    "t_s": "s",
    "current_command_A": "A",
    "current_A": "A",
    "voltage_V": "V",
    "temperature_degC": "degC",
    "ambient_degC": "degC",
    "counts": "count",
}


def parquet(run: Run, path: Path) -> None:
    """Columnar samples with units and the run's whole description; needs pyarrow."""
    try:
        import pyarrow as pa
        import pyarrow.parquet as pq
    except ImportError:
        raise UsageError("Parquet needs pyarrow: pip install 'smarig[parquet]'.") from None
    units = {**_UNITS, "input": run.input_unit, "position": run.unit}
    kept = [name for name in SAMPLE_COLUMNS if name in ("tick", "quality") or run.has(name)]
    fields = [
        pa.field(
            name,
            pa.int64() if name in _INTEGERS else pa.float64(),
            metadata={"unit": units[name]} if units.get(name) else None,
        )
        for name in kept
    ]
    metadata = {
        "smarig.run": json.dumps(run.meta),
        "smarig.steps": json.dumps([asdict(s) for s in run.steps]),
        "smarig.events": json.dumps([asdict(e) for e in run.events]),
    }
    arrays = [
        pa.array(np.nan_to_num(run[f.name]), type=pa.float64(), mask=np.isnan(run[f.name])).cast(f.type)
        for f in fields
    ]
    pq.write_table(pa.Table.from_arrays(arrays, schema=pa.schema(fields, metadata=metadata)), path)
