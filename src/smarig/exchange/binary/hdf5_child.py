"""The program that reads an HDF5 file, in a process of its own, because the library fails badly on damaged files: it
loops, needs all memory, or ends the process. It imports nothing of smarig.

The first argument is the file, the second a group, or "" for all. Once the file is open, this process may open no
other: neither data in other files, nor pipes and devices, nor libraries of filters can be reached, whatever the file
names. What is known to lead there is refused by name. The answers are lines of JSON on stdout, each column followed by
its values in 8 bytes; ``end`` is the last.
"""

import contextlib
import io
import itertools
import json
import math
import sys
from collections.abc import Iterator
from typing import Any, BinaryIO

import h5py
import numpy as np

MAX_VALUES = 50_000_000  # of all columns
MAX_CHUNK_BYTES = 400_000_000
MAX_GROUPS = 1000
MAX_COLUMNS = 200
MAX_ATTRIBUTES = 100
MAX_NAME = 200  # characters; texts are cut there
CPU_S, MEMORY_BYTES = 120, 4_000_000_000
_OWN_FILTERS = (  # of HDF5 itself; others are libraries that it would load
    *(h5py.h5z.FILTER_DEFLATE, h5py.h5z.FILTER_SHUFFLE, h5py.h5z.FILTER_FLETCHER32),
    *(h5py.h5z.FILTER_SZIP, h5py.h5z.FILTER_NBIT, h5py.h5z.FILTER_SCALEOFFSET),
    h5py.h5z.FILTER_LZF,  # of h5py
)
_UNIT_KEYS = ("units", "unit", "Units", "Unit", "UNITS")


class _Refused(Exception):
    """A part of the file is not read; the text says which and why."""


def answer(path: str, group: str, out: BinaryIO) -> None:
    """Everything that is read from a file, or why it is not: the one place where errors of the library end."""
    try:
        _answer(path, group, out)
    except _Refused as refusal:
        _send(out, {"refused": str(refusal)})
    except MemoryError:
        _send(out, {"refused": "reading it needs too much memory. Split it."})
    except Exception as error:  # h5py raises what the library's message reminds it of
        _send(out, {"damaged": type(error).__name__})


def _answer(path: str, group: str, out: BinaryIO) -> None:
    _rehearse()
    with h5py.File(path, "r") as file:
        _open_nothing_else()
        groups = _all_groups(file) if not group else [(group, _group(file, group))]
        values = 0
        for name, found in groups:
            columns, left_out = _columns(found)
            values += sum(column.length for column in columns)
            if values > MAX_VALUES:
                raise _Refused(f"it holds more than {MAX_VALUES // 10**6} million values. Split it.")
            words = {"group": name, "header": _header(found), "left_out": left_out}
            _send(out, words | {"scalars": _scalars(found)})
            for column in columns:
                for own, unit, numbers in column.values():
                    words = {"column": own, "unit": unit, "comment": column.comment, "size": numbers.size}
                    _send(out, words | {"start": column.start})
                    out.write(numbers.data)
    _send(out, {"end": True})


def _send(out: BinaryIO, words: dict[str, Any]) -> None:
    out.write(json.dumps(words).encode() + b"\n")
    out.flush()


def limit() -> None:
    """Bounds of time and memory; where the system has none, the caller's clock ends this process."""
    with contextlib.suppress(ImportError, ValueError, OSError):
        import resource

        resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
        resource.setrlimit(resource.RLIMIT_CPU, (CPU_S, CPU_S))
        resource.setrlimit(resource.RLIMIT_AS, (MEMORY_BYTES, MEMORY_BYTES))


def _rehearse() -> None:
    """Read a file of every kind of content in memory: what Python loads on demand is loaded before it is too late."""
    with h5py.File(io.BytesIO(), "w") as file:
        file["table"] = np.zeros(2, [("n", "f8"), ("text", "S2"), ("pair", "f4", (2,))])
        file["texts"], file["flags"] = ["a", "b"], np.zeros((2, 2), dtype=bool)
        file["links"] = np.array([file["flags"].ref], dtype=h5py.ref_dtype)
        file["flags"].attrs["names"] = ["é", "b"]
        file["flags"].attrs["bytes"], file["flags"].attrs["unit"] = np.array([b"a"]), "mm"
        file.create_dataset("packed", data=[[1.0, 2.0]], chunks=True, compression="gzip", shuffle=True)
        file.flush()
        for data in file.values():
            _plain([data[()], _header(data), _no_column(data)])
            if not _no_column(data):
                _check("", data)
                list(_Column("", data).values())
        file["scalar"] = 1.0
        _scalars(file)


def _open_nothing_else() -> None:
    with contextlib.suppress(ImportError, ValueError, OSError):
        import resource

        resource.setrlimit(resource.RLIMIT_NOFILE, (0, 0))


def _all_groups(file: Any) -> Iterator[tuple[str, Any]]:
    """All groups with their paths, each once, the file itself first."""
    waiting, seen = [("/", file)], {file["/"].id}
    count = 0
    while waiting and count < MAX_GROUPS:
        name, group = waiting.pop(0)
        count += 1
        yield name, group
        for key in _keys(group, MAX_GROUPS):
            child = _member(group, key)
            if isinstance(child, h5py.Group) and child.id not in seen:
                seen.add(child.id)
                waiting.append((f"{name.rstrip('/')}/{_plain(key)}", child))


def _group(file: Any, path: str) -> Any:
    found = file
    for key in filter(None, path.encode("utf-8", "replace").split(b"/")):
        found = _member(found, key)
        if not isinstance(found, h5py.Group):
            raise _Refused(f"there is no group '{path[:MAX_NAME]}' in it.")
    return found


def _keys(group: Any, most: int) -> list[bytes]:
    return list(itertools.islice(group.id, most))


def _member(group: Any, key: bytes) -> Any:
    """A member of a group that lies directly in it, else None: links, also to other files, are not followed."""
    links = group.id.links
    return group[key] if links.exists(key) and links.get_info(key).type == h5py.h5g.LINK_HARD else None


class _Column:
    """A data set that becomes one column, or several of one length."""

    def __init__(self, name: str, data: Any) -> None:
        self.name, self._data = name, data
        attributes = _attributes(data)
        self.comment = _plain(attributes.get("long_name", attributes.get("description", "")))
        self.start = _plain(attributes.get("start", ""))  # of a clock: its zero
        rows, width = (math.prod(data.shape), len(data.dtype)) if data.dtype.names else (*data.shape, 1)[:2]
        self._turned = not data.dtype.names and (width > MAX_COLUMNS or rows < width)
        self.length, self.width = (width, rows) if self._turned else (rows, width)

    def values(self) -> Iterator[tuple[str, str, Any]]:
        """Name, unit and numbers of each column."""
        data = self._data[()]
        if data.dtype.names:
            for field in data.dtype.names:
                if _is_number(data.dtype[field]):
                    yield f"{self.name}/{field}", "", _floats(data[field].ravel())
        elif self.width == 1:  # MATLAB has no other vectors than matrices of one row or column
            yield self.name, _unit(self._data), _floats(data.ravel())
        else:
            data = data.T if self._turned else data
            for k, name in enumerate(_column_names(self._data, self.width)):
                yield f"{self.name}/{name}", "", _floats(data[:, k])


def _columns(group: Any) -> tuple[list[_Column], dict[str, str]]:
    """The columns of the most frequent length in a group, and data sets that are none, with the reason."""
    found: list[_Column] = []
    left_out: dict[str, str] = {}
    for key in _keys(group, MAX_COLUMNS):
        member, name = _member(group, key), _plain(key)
        if member is None:
            left_out[name] = "is a link, which is not followed"
        elif isinstance(member, h5py.Dataset):
            if why := _no_column(member):
                left_out[name] = why
            else:
                _check(name, member)
                found.append(_Column(name, member))
    lengths = [column.length for column in found for _ in range(column.width)]
    usual = max(set(lengths), key=lambda n: (lengths.count(n), n), default=0)
    return [column for column in found if column.length == usual >= 2], left_out


def _scalars(group: Any) -> dict[str, tuple[float, str]]:
    """The single numbers in a group by name, each with its unit."""
    found = {}
    for key in _keys(group, MAX_COLUMNS):
        member = _member(group, key)
        if (
            isinstance(member, h5py.Dataset)
            and member.shape in ((), (1,), (1, 1))
            and _is_number(member.dtype)
        ):
            _check(_plain(key), member)
            value = float(np.asarray(member[()]).ravel()[0])
            if math.isfinite(value):
                found[_plain(key)] = (value, _unit(member))
    return found


def _no_column(data: Any) -> str:
    """Why a data set is no column of numbers, or "" """
    kind = data.dtype
    if h5py.check_ref_dtype(kind) is not None:
        return "holds references to other objects, which are not followed"
    if not (_is_number(kind) or any(_is_number(kind[field]) for field in kind.names or ())):
        return "holds no numbers"
    if data.shape is None or len(data.shape) not in (1, 2) or 0 in data.shape:
        return "has no rows, or more than two dimensions"
    if min(data.shape if len(data.shape) == 2 else (1,)) > MAX_COLUMNS:
        return f"has more than {MAX_COLUMNS} columns"
    return ""


def _is_number(kind: Any) -> bool:
    return np.issubdtype(kind, np.number) and not np.issubdtype(kind, np.complexfloating)


def _check(name: str, data: Any) -> None:
    """Refuse a data set that is too large, or whose values are not in this file, or packed by a plug-in."""
    plan, where = data.id.get_create_plist(), f"data set '{name}'"
    layout = plan.get_layout()
    if layout == h5py.h5d.VIRTUAL:
        raise _Refused(f"{where} is virtual: its values come from other data sets. Copy them into one file.")
    if plan.get_external_count():
        raise _Refused(
            f"{where} keeps its values in another file, which is not followed. Copy them into one file (h5repack)."
        )
    for k in range(plan.get_nfilters()):
        number = plan.get_filter(k)[0]
        if number not in _OWN_FILTERS:
            raise _Refused(
                f"{where} is packed by filter {number}, a plug-in, which is not loaded. "
                "Pack it with gzip: h5repack -f GZIP=1 OLD NEW."
            )
    size = data.dtype.itemsize
    if math.prod(data.shape) > MAX_VALUES:
        raise _Refused(f"{where} has more than {MAX_VALUES // 10**6} million values. Split it.")
    if layout == h5py.h5d.CHUNKED and math.prod(plan.get_chunk()) * size > MAX_CHUNK_BYTES:
        raise _Refused(
            f"{where} is stored in pieces of more than {MAX_CHUNK_BYTES // 10**6} MB. Copy it with smaller ones."
        )


def _column_names(data: Any, columns: int) -> list[str]:
    """The names of the columns of a matrix from an attribute of that many texts, else their numbers."""
    for key, value in _attributes(data).items():
        if key.startswith("MATLAB"):
            continue
        texts = np.atleast_1d(value)
        if texts.size == columns and texts.dtype.kind in "SUO":
            return [_plain(text) for text in texts]
    return [f"column {k + 1}" for k in range(columns)]


def _unit(data: Any) -> str:
    found = _attributes(data)
    return next((_plain(found[key]) for key in _UNIT_KEYS if key in found), "")


def _header(group: Any) -> dict[str, str]:
    return {name: _plain(value) for name, value in _attributes(group).items()}


def _attributes(item: Any) -> dict[str, Any]:
    """The first attributes of a group or data set, without those that are large or cannot be read as they are."""
    found = {}
    for k in range(min(h5py.h5a.get_num_attrs(item.id), MAX_ATTRIBUTES)):
        own = h5py.h5a.open(item.id, index=k)
        if math.prod(own.shape or ()) <= MAX_COLUMNS:
            with contextlib.suppress(OSError, TypeError, ValueError, KeyError):
                found[_plain(own.name)] = item.attrs[own.name]
    return found


def _plain(value: Any) -> str:
    """A text of the file, cut, and without bytes that are no text."""
    data = value if isinstance(value, bytes) else str(value)[:MAX_NAME].encode("utf-8", "replace")
    return data.decode("utf-8", "replace")[:MAX_NAME]


def _floats(values: Any) -> Any:
    found = np.array(values, dtype=np.float64)
    found[np.isinf(found)] = np.nan
    return found


if __name__ == "__main__":
    limit()
    answer(sys.argv[1], sys.argv[2], sys.stdout.buffer)
