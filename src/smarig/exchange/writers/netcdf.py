"""Writes a run as NetCDF-4 with Climate and Forecast conventions, for xarray, MATLAB's ncread, Panoply and ncdump.

Samples are in the root, on the coordinate ``time`` (or ``tick``, for data without time). Steps and events are groups.
Texts are character arrays and attributes are characters, which every NetCDF reader supports. The file is built in
memory, because HDF5 ends the process when it writes to a full disk, and by h5netcdf alone, because xarray takes 100 MB
more.
"""

import io
import json
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from datetime import UTC, datetime, timedelta
from importlib.metadata import version
from pathlib import Path
from typing import Any

import numpy as np

from smarig.core import MissingExtra, UsageError
from smarig.exchange.export_columns import (
    FLAGS,
    ExportColumn,
    event_columns,
    integers,
    label,
    sample_columns,
    step_columns,
    title,
)
from smarig.exchange.run_clock import zero_epoch
from smarig.record import AnyRun

_MISSING = np.iinfo(np.int32).min
_UNITS = {"deg": "degree", "degC": "degree_Celsius", "count": "1", "": "1"}  # names in UDUNITS
_STANDARD = {"ambient_degC": "air_temperature", "quality": "quality_flag"}
_DEFLATE = 4
MAX_TEXT_BYTES = 500_000_000


@dataclass(frozen=True)
class _Variable:
    """A variable of the file: its dimension ("" for a scalar), values, attributes."""

    along: str
    values: np.ndarray
    attributes: dict[str, Any]


def netcdf(run: AnyRun, path: Path) -> None:
    """NetCDF-4 with CF attributes, steps and events as groups; for xarray and MATLAB's ncread (extra netcdf)."""
    try:
        import h5netcdf
        import h5py  # noqa: F401 - used by h5netcdf
    except ImportError:
        raise MissingExtra("NetCDF export", "netcdf") from None
    made = io.BytesIO()
    with h5netcdf.File(made, "w") as file:
        file.attrs.update(_characters(_description(run)))
        for name, variable in _root_variables(run):
            _write(file, name, variable)
        for name, columns in (("step", step_columns(run)), ("event", event_columns(run))):
            group = file.create_group(f"{name}s")
            group.attrs.update(_characters({"title": f"{name.capitalize()}s of the run"}))
            for column in columns:
                _write(group, column.name, _sampled(column, name))
    path.write_bytes(made.getbuffer())


def _root_variables(run: AnyRun) -> Iterator[tuple[str, _Variable]]:
    """Column by column, so that one is in memory at a time."""
    columns, clock = sample_columns(run), _has_clock(run)
    along = "time" if clock else "tick"
    yield along, _time(run) if clock else _sampled(columns.pop(0), along)
    for column in columns:
        yield column.name, _sampled(column, along)
    yield "smarig_run", _full_description(run)


def _write(group: Any, name: str, variable: _Variable) -> None:
    """Numbers deflated, texts as an array of characters with a dimension for their length.

    Integer columns with missing values get a fill value, because readers convert columns with one to floats.
    """
    values, along = variable.values, [variable.along] if variable.along else []
    if values.dtype.kind == "S":
        along.append(f"string{values.dtype.itemsize}")
        values = values[..., None].view("S1")
    for dimension, size in zip(along, values.shape, strict=True):
        if dimension not in group.dimensions:
            group.dimensions[dimension] = size
    options: dict[str, Any] = {}
    if values.dtype.kind in "fi" and values.size:
        options = {"compression": "gzip", "compression_opts": _DEFLATE, "shuffle": True}
    if values.dtype.kind in "fi" and name not in group.dimensions:  # a coordinate has no missing values
        fill = np.nan if values.dtype.kind == "f" else _MISSING
        options["fillvalue"] = fill if fill != fill or (values == fill).any() else None
    made = group.create_variable(name, tuple(along), values.dtype, data=values, **options)
    made.attrs.update(variable.attributes)


def _has_clock(run: AnyRun) -> bool:
    t_s = run["t_s"]
    return bool(len(run)) and bool(np.isfinite(t_s).all()) and bool((np.diff(t_s) > 0).all())


def _time(run: AnyRun) -> _Variable:
    """Time in seconds since the zero of the device's clock, in host time; without reference if that is unknown."""
    epoch = zero_epoch(run)
    attributes = {"long_name": "time of the sample", "units": "s", "axis": "T"}
    if epoch is not None:
        moment = (datetime(1970, 1, 1, tzinfo=UTC) + timedelta(seconds=epoch)).strftime(
            "%Y-%m-%dT%H:%M:%S.%f"
        )
        attributes |= {"units": f"seconds since {moment}Z", "calendar": "standard", "standard_name": "time"}
    return _Variable("time", run["t_s"], _characters(attributes))


def _sampled(column: ExportColumn, along: str) -> _Variable:
    texts = {"long_name": column.what, "standard_name": _STANDARD.get(column.name, "")}
    texts |= {"_Encoding": "utf-8"} if column.text else {"units": _UNITS.get(column.unit, column.unit)}
    attributes: dict[str, Any] = _characters(texts)
    if column.name == "quality":
        attributes |= {"flag_masks": np.array(list(FLAGS), dtype=np.int32)}
        attributes |= _characters({"flag_meanings": " ".join(FLAGS.values())})
    if column.name == "void":
        attributes |= {"flag_values": np.array([0, 1], dtype=np.int32)} | _characters(
            {"flag_meanings": "counts void"}
        )
    return _Variable(along, _values(column), attributes)


def _values(column: ExportColumn) -> np.ndarray:
    """Texts as bytes of one length; integers as 32 bits if they fit."""
    values = column.values
    if column.text:
        return _bytes_of_one_length([text.encode("utf-8") for text in values.tolist()])
    if not column.whole:
        return values
    whole = integers(values, _MISSING)
    fits = not whole.size or np.abs(whole).max() <= -_MISSING
    return whole.astype(np.int32) if fits else whole


def _bytes_of_one_length(texts: list[bytes]) -> np.ndarray:
    longest = max(map(len, texts), default=1)
    if longest * len(texts) > MAX_TEXT_BYTES:
        raise UsageError(
            f"NetCDF would need {longest * len(texts) / 1e6:.0f} MB for the texts of this run. Export it to mat or "
            "parquet."
        )
    return np.array(texts, dtype=f"S{max(longest, 1)}")


def _description(run: AnyRun) -> dict[str, Any]:
    now = datetime.now(UTC).strftime("%Y-%m-%dT%H:%M:%SZ")
    measured = {"BENCH": "measured on a rig", "TWIN": "from a software twin, not measured"}
    whose = label(run)
    return {
        "Conventions": "CF-1.11",
        "title": title(run),
        "source": f"{whose}: {measured.get(whose, 'see smarig_run')}",
        "history": f"{now} exported by smarig {version('smarig')} from {run.path.name}",
        "comment": run.info.notes or "",
        "ended": run.cause,
    }


def _full_description(run: AnyRun) -> _Variable:
    """The whole description as a variable, because attributes are limited to 64 kB."""
    text = json.dumps(run.meta, ensure_ascii=False).encode("utf-8")
    attributes = {"long_name": "whole description of the run, JSON", "_Encoding": "utf-8"}
    return _Variable("", np.array(text), _characters(attributes))


def _characters(texts: Mapping[str, Any]) -> dict[str, Any]:
    """Attributes as characters, because not every reader supports texts of variable length; "" is left out."""
    return {key: np.bytes_(str(value).encode("utf-8")) for key, value in texts.items() if value != ""}
