"""Honest HDF5 files of both formats of metadata, and of every kind of storage that lies inside the file."""

import io
from typing import Any

import numpy as np

from mutated.table_formats import COLUMNS, ROWS, T_S, U_DEGC, UNITS, X_MM


def hdf5s() -> list[bytes]:
    """Vectors, tables, matrices, odd types, and many groups, each in old and in new metadata."""
    makers = (_vectors, _packed, _table, _matrix, _odd, _groups)
    return [_made(maker, libver) for libver in ("earliest", "latest") for maker in makers]


def everything(libver: str) -> bytes:
    """All of these in one file, each in a group of its own."""

    def fill(file: Any) -> None:
        for maker in (_vectors, _packed, _table, _matrix, _odd, _groups):
            maker(file.create_group(maker.__name__.strip("_")))

    return _made(fill, libver)


def matlab_73s() -> list[bytes]:
    """As MATLAB 7.3 writes: 512 bytes of its own before the HDF5 file; matrices of one column or row, a struct."""
    return [
        b"MATLAB 7.3 MAT-file".ljust(508, b" ") + b"\x00\x02IM" + _made(maker, "earliest")
        for maker in (_matlab, _matlab_struct)
    ]


def _made(fill: Any, libver: str) -> bytes:
    import h5py

    made = io.BytesIO()
    with h5py.File(made, "w", libver=libver) as file:
        fill(file)
    return made.getvalue()


def _vectors(file: Any) -> None:
    group = file.create_group("run1")
    for (name, x), unit in zip(COLUMNS.items(), UNITS):
        group[name] = x
        group[name].attrs["units"] = unit
    group.attrs["specimen"], group.attrs["load"], group["scalar"] = "A", np.float32(3), 3.0


def _packed(file: Any) -> None:
    for name, x in COLUMNS.items():
        file.create_dataset(name, data=x, chunks=(7,), compression="gzip", shuffle=True, fletcher32=True)
    file.create_dataset("scaled", data=np.arange(ROWS), chunks=(10,), scaleoffset=4)
    file.create_dataset("growing", data=X_MM, maxshape=(None,), chunks=(16,))


def _table(file: Any) -> None:
    kind = [("t", "<f8"), ("T", ">f4"), ("x", "<f2"), ("n", "u1"), ("note", "S4"), ("pair", "f4", (2,))]
    rows = [(t, u, x, 1, b"ab", (1, 2)) for t, u, x in zip(T_S, U_DEGC, X_MM)]
    file["table"] = np.array(rows, dtype=kind)
    file["table"].attrs["unit"] = b"s"


def _matrix(file: Any) -> None:
    import h5py

    file["data"] = np.column_stack([T_S, U_DEGC, X_MM])
    file["data"].attrs["names"] = ["t", "T", "x"]
    file["turned"] = np.vstack([T_S, U_DEGC, X_MM])
    file["data"].attrs.create("words", ["a", "bc"], dtype=h5py.string_dtype())


def _odd(file: Any) -> None:
    import h5py

    file["text"] = "words"
    file.create_dataset("texts", data=["a"] * ROWS, dtype=h5py.string_dtype())
    file.create_dataset("lists", (ROWS,), dtype=h5py.vlen_dtype(np.float64))
    file.create_dataset("links", (ROWS,), dtype=h5py.ref_dtype)
    file["states"] = np.zeros(ROWS, dtype=h5py.enum_dtype({"OFF": 0, "ON": 1}))
    file["flags"], file["complex"], file["half"] = X_MM > 5, X_MM + 1j, X_MM.astype("f2")
    file["opaque"], file["empty"] = np.zeros(ROWS, "V5"), h5py.Empty("f8")
    file["time"], file["x"] = T_S.astype(">f4"), X_MM.astype("i2")
    file["link"] = h5py.SoftLink("x")
    file["kind"] = np.dtype("f8")


def _groups(file: Any) -> None:
    for k in range(12):
        for name, x in COLUMNS.items():
            file[f"cycle {k}/sub/{name}"] = x[: 10 + k]
        file[f"cycle {k}"].attrs["load"] = k


def _matlab(file: Any) -> None:
    for name, x in COLUMNS.items():
        file.create_dataset(name, data=x[None, :], chunks=(1, 20), compression="gzip")
        file[name].attrs["MATLAB_class"] = np.bytes_("double")


def _matlab_struct(file: Any) -> None:
    file.create_group("data").attrs["MATLAB_class"] = np.bytes_("struct")
    for name, x in COLUMNS.items():
        file["data"][name] = x[:, None]
    file["note"] = np.frombuffer("words".encode("utf-16-le"), "u2")[:, None]
    file["note"].attrs["MATLAB_class"] = np.bytes_("char")
