"""Writes a run's samples as Parquet, with units, description, steps and events in the schema's metadata."""

import json
from dataclasses import asdict
from pathlib import Path

import numpy as np

from smarig.core import UsageError
from smarig.exchange.export_columns import label, sample_columns, title
from smarig.record import Run


def parquet(run: Run, path: Path) -> None:
    """Columns with units and the whole description as metadata; for pandas, polars, DuckDB, R (extra parquet)."""
    try:
        import pyarrow as pa
        import pyarrow.parquet as pq
    except ImportError:
        raise UsageError("Parquet export needs pyarrow: pip install 'smarig[parquet]'.") from None
    columns = sample_columns(run)
    fields = [
        pa.field(
            c.name,
            pa.int64() if c.whole else pa.float64(),
            metadata={"what": c.what} | ({"unit": c.unit} if c.unit else {}),
        )
        for c in columns
    ]
    metadata = {
        "smarig.title": title(run),
        "smarig.source": label(run),
        "smarig.ended": run.cause,
        "smarig.run": json.dumps(run.meta),
        "smarig.steps": json.dumps([asdict(s) for s in run.steps]),
        "smarig.events": json.dumps([asdict(e) | {"severity": e.severity} for e in run.events]),
    }
    arrays = [
        pa.array(np.nan_to_num(c.values), type=pa.float64(), mask=np.isnan(c.values)).cast(f.type)
        for c, f in zip(columns, fields, strict=True)
    ]
    table = pa.Table.from_arrays(arrays, schema=pa.schema(fields, metadata=metadata))
    pq.write_table(table, path, compression="zstd")
