"""Writes a run's samples as Parquet, with units, description, steps and events in the schema's metadata."""

import json
from dataclasses import asdict
from pathlib import Path
from typing import Any

import numpy as np

from smarig.core import Array, MissingExtra
from smarig.exchange.export_columns import integers, label, sample_columns, title
from smarig.record import AnyRun

GROUP_ROWS = 100_000  # of a row group, which is compressed as a whole


def parquet(run: AnyRun, path: Path) -> None:
    """Columns with units and the whole description as metadata; for pandas, polars, DuckDB, R (extra parquet)."""
    try:
        import pyarrow as pa
        import pyarrow.parquet as pq
    except ImportError:
        raise MissingExtra("Parquet export", "parquet") from None
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
    schema = pa.schema(fields, metadata=metadata)
    with pq.ParquetWriter(path, schema, compression="zstd") as writer:
        for block in run.blocks([c.name for c in columns], GROUP_ROWS):
            arrays = [_array(block[c.name], c.whole) for c in columns]
            writer.write_table(pa.Table.from_arrays(arrays, schema=schema))


def _array(values: Array, whole: bool) -> Any:
    """An arrow array, null where unknown. From buffers, because ``pa.array`` imports pandas."""
    import pyarrow as pa

    known = np.packbits(~np.isnan(values), bitorder="little")
    data = integers(values, 0) if whole else np.nan_to_num(values)
    buffers = [pa.py_buffer(known), pa.py_buffer(np.ascontiguousarray(data))]
    return pa.Array.from_buffers(pa.int64() if whole else pa.float64(), values.size, buffers)
