"""A run as a data frame of pandas, or as a data set of xarray."""

import importlib
from types import ModuleType
from typing import TYPE_CHECKING, Any

from smarig.core import UsageError
from smarig.record.schema import SAMPLE_COLUMNS

if TYPE_CHECKING:
    from smarig.record.run import Run


def frame_of(run: "Run") -> Any:
    """The samples as a ``pandas.DataFrame``: known columns, with the time (or the tick, if none is known) as index.

    ``attrs`` holds protocol, rig, wire, and the units of input and output; other columns name theirs. Raises
    UsageError without pandas.
    """
    pandas = _imported("pandas")
    index = "t_s" if run.has("t_s") else "tick"
    names = [name for name in SAMPLE_COLUMNS if name != index and run.has(name)]
    frame = pandas.DataFrame({name: run[name] for name in names}, index=pandas.Index(run[index], name=index))
    frame.attrs.update(_description(run))
    return frame


def dataset_of(run: "Run") -> Any:
    """The samples as an ``xarray.Dataset`` over the same index, with units. Raises UsageError without xarray."""
    xarray = _imported("xarray")
    index = "t_s" if run.has("t_s") else "tick"
    names = [name for name in SAMPLE_COLUMNS if name != index and run.has(name)]
    units = {"position": run.unit, "input": run.input_unit}
    data = {name: (index, run[name], {"units": units[name]} if name in units else {}) for name in names}
    return xarray.Dataset(data, coords={index: run[index]}, attrs=_description(run))


def _description(run: "Run") -> dict[str, str]:
    """Texts only: NetCDF takes no others."""
    found = {
        "protocol": run.info.protocol,
        "rig": run.info.rig,
        "wire": run.info.wire,
        "input_unit": run.input_unit,
        "output_unit": run.unit,
    }
    return {key: str(value) for key, value in found.items() if value}


def _imported(name: str) -> ModuleType:
    try:
        return importlib.import_module(name)
    except ImportError:
        raise UsageError(f"This needs {name}, which is not installed: pip install {name}") from None
