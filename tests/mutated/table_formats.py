"""Honest tables in every container that smarig reads: what mutated tables are made from."""

import io
import json
from collections.abc import Callable

import numpy as np

ROWS = 60
T_S = np.arange(ROWS) * 0.5
U_DEGC = 25 + 60 * np.abs(np.sin(np.linspace(0, 6, ROWS)))
X_MM = 0.1 * U_DEGC + np.sin(np.linspace(0, 5, ROWS))
NAMES = ("time", "temperature", "displacement")
UNITS = ("s", "degC", "mm")
COLUMNS = dict(zip(NAMES, (T_S, U_DEGC, X_MM)))
Seeds = Callable[[], list[bytes]]


def texts() -> list[bytes]:
    """Dialects: smarig's own columns, German numbers with units, tabs below a header, a clock, columns of blanks,
    documents of JSON.
    """
    rows = list(zip(T_S, U_DEGC, X_MM))
    own = "time_s,current_command_A,position_mm\n" + "".join(
        f"{t},{u / 100:.3f},{x:.5f}\n" for t, u, x in rows
    )
    german = "Zeit;Temperatur;Weg\ns;°C;mm\n" + "".join(
        f"{t:.1f};{u:.3f};{x:.4f}\n".replace(".", ",") for t, u, x in rows
    )
    tabs = "Rig: A\nSpecimen: 3 \nload [MPa]: 100\n\nTime (s)\tTemp (degC)\tStrain (%)\n" + "".join(
        f"{t}\t{u:e}\t{x / 10:e}\n" for t, u, x in rows
    )
    clock = "when,T/degC,x/mm,note\n" + "".join(
        f"2024-01-02 10:{int(t) // 60:02d}:{t % 60:04.1f},{u:.2f},{x:.4f},ok\n" for t, u, x in rows
    )
    blanks = "# T   x\n" + "".join(f"  {u:10.4f}   {x:10.5f}\n" for _, u, x in rows)
    stamped = "".join(
        f"10:00:{k:02d}.5 -> t={t} I={u / 100:.3f} T={u:.2f} pos={x:.4f}\n"
        for k, (t, u, x) in enumerate(rows)
    )
    wide = "T up,x up,T down,x down\n" + "".join(
        f"{u:.2f},{x:.3f},{u - 5:.2f},{x + 1:.3f}\n" for _, u, x in rows
    )
    columns = {name: {"unit": unit, "values": x.tolist()} for (name, x), unit in zip(COLUMNS.items(), UNITS)}
    series = {
        "series": [{"name": "rig", "columns": NAMES, "values": [[float(x) for x in row] for row in rows]}]
    }
    records = [dict(zip(NAMES, map(float, row))) for row in rows]
    documents = map(json.dumps, (columns, series, records, [NAMES, *series["series"][0]["values"]]))
    return [
        *(text.encode() for text in (own, german, tabs, clock, blanks, stamped, wide, *documents)),
        tabs.encode("utf-16"),
        german.encode("cp1252"),
        own.replace("\n", "\r\n").encode("utf-8-sig"),
    ]


def own_csvs() -> list[bytes]:
    """smarig's own columns: least of them; all of them, with marks and steps; counts of an encoder."""
    rows = list(zip(T_S, U_DEGC / 100, X_MM))
    least = "time_s,current_A,position_mm\n" + "".join(f"{t},{u:.3f},{x:.5f}\n" for t, u, x in rows)
    most = (
        "time_s,current_command_A,current_A,position_deg,voltage_V,ambient_degC,temperature_degC,step,flags\n"
        + "".join(
            f"{t},{u:.2f},{u:.3f},{x:.5f},{9 * u:.3f},21.5,{100 * u:.2f},{k // 9},0\n"
            for k, (t, u, x) in enumerate(rows)
        )
    )
    counts = "time_s,current_command_A,position_counts\n" + "".join(
        f"{t},{0.4 * (k // 20 % 2)},{round(20 * x)}\n" for k, (t, _, x) in enumerate(rows)
    )
    return [text.encode() for text in (least, most, counts)]


def forc() -> list[bytes]:
    """A file of reversal curves with calibration points, and one of an older series."""
    head = (
        "MicroMag 2900/3900 Data File (Series 0015)\nFirst-order reversal curves\nConfiguration   :  VSM\n"
        "Units of measure:  {units}\n\nHCal           = +1.0E+00\nHSat           = +2.0E+00\n"
        "NCrv           = 8\nMoment range   = +2.0E+01\n\nNData          = 72\n\n"
    )
    blocks = []
    for turn in np.linspace(0.4, -0.8, 8):
        curve = "".join(f"{h:+E},{np.tanh(4 * h) + 0.1 * turn:+E}\n" for h in np.linspace(turn, 0.9, 9))
        blocks.append(f"+1.0E+00,+1.0E+00\n\n{curve}\n")
    body = "".join(blocks) + "\nMicroMag 2900/3900 Data File ends\n"
    plain = "\n".join(block.split("\n\n")[1] for block in blocks)
    return [
        (head.format(units="SI") + body).encode(),
        (head.format(units="Hybrid SI") + body).replace("=", ":").encode(),
        (head.format(units="cgs") + "\n" + plain).encode("cp1252"),
    ]


def workbooks() -> list[bytes]:
    """Two sheets, with a title, units, dates and formulas."""
    import openpyxl

    book = openpyxl.Workbook()
    sheet = book.active
    sheet.title = "Messung 1"
    for row in (["Rig A"], ["when", *NAMES], ["", *UNITS]):
        sheet.append(row)
    from datetime import datetime, timedelta

    for k in range(ROWS):
        sheet.append([datetime(2024, 1, 2) + timedelta(seconds=k), T_S[k], U_DEGC[k], f"{X_MM[k]:.3f}"])
    book.create_sheet("notes").append(["=1+1", True, None, "text"])
    return [_saved(book.save)]


def parquets() -> list[bytes]:
    """Several types of columns; each compression; a dictionary; nested and empty columns."""
    import pyarrow as pa
    from pyarrow import parquet

    plain = pa.table({name: pa.array(x) for name, x in COLUMNS.items()})
    when = pa.array((T_S * 1000).astype("int64"), pa.timestamp("ms"))
    odd = pa.table(
        {
            "when": when,
            "T": pa.array(U_DEGC.astype("f4")),
            "x": pa.array(X_MM),
            "n": pa.array(range(ROWS), pa.uint8()),
            "note": pa.array(["a", "b"] * (ROWS // 2)).dictionary_encode(),
            "none": pa.nulls(ROWS),
            "list": pa.array([[1.0, 2.0]] * ROWS),
        }
    )
    kinds = ((plain, "none"), (plain, "snappy"), (odd, "zstd"), (odd, "none"))
    return [_saved(lambda f, t=t, c=c: parquet.write_table(t, f, compression=c)) for t, c in kinds]


def tdmss() -> list[bytes]:
    """Files of LabVIEW with a clock; in several segments, other types and a group that is no table; interleaved."""
    from nptdms import ChannelObject, GroupObject, RootObject, TdmsWriter

    def channel(name: str, values: np.ndarray, unit: str) -> ChannelObject:
        clock = {"unit_string": unit, "wf_increment": 0.5, "wf_start_offset": 0.0}
        return ChannelObject("Run", name, values, properties=clock)

    def written(segments: list[list[ChannelObject]]) -> bytes:
        file = io.BytesIO()
        with TdmsWriter(file) as writer:
            for channels in segments:
                writer.write_segment([RootObject({"name": "rig"}), GroupObject("Run"), *channels])
        return file.getvalue()

    whole = [channel("Temperature", U_DEGC, "degC"), channel("Displacement", X_MM, "mm")]
    halves = [
        [
            channel("Temperature", U_DEGC[part].astype("f4"), "degC"),
            channel("Displacement", 100 * X_MM[part], "um"),
        ]
        for part in (slice(0, ROWS // 2), slice(ROWS // 2, ROWS))
    ]
    counts = [channel("Temperature", U_DEGC.astype("i2"), "degC"), channel("Displacement", X_MM, "mm")]
    texts_too = [*whole, ChannelObject("notes", "text", np.array(["a", "b"]))]
    return [written([whole]), written(halves), written([counts]), written([texts_too])]


def matlabs() -> list[bytes]:
    """MATLAB 5, deflated and not, with structs, arrays of structs and texts; MATLAB 4, which is refused."""
    from scipy.io import savemat

    columns = {name: x[:, None] for name, x in COLUMNS.items()}
    nested = {"data": dict(columns), "note": "text", "cell": np.array([1, "a"], dtype=object)}
    found = [_saved(lambda f, c=c: savemat(f, columns, do_compression=c)) for c in (False, True)]
    found.append(_saved(lambda f: savemat(f, nested, do_compression=True)))
    signals = np.zeros((1, len(NAMES)), dtype=[("Name", object), ("Data", object), ("Unit", object)])
    for k, (name, unit) in enumerate(zip(NAMES, UNITS)):
        signals[0, k] = (name, columns[name], unit)
    found.append(_saved(lambda f: savemat(f, {"rec": {"Y": signals}}, do_compression=True)))
    found.append(
        _saved(lambda f: savemat(f, {"T": np.outer(U_DEGC, [1, 2, 3]), "x": np.outer(X_MM, [1, 2, 3])}))
    )
    found.append(_saved(lambda f: savemat(f, {k: np.asarray(v) for k, v in COLUMNS.items()}, format="4")))
    return found


def _saved(save: Callable[[io.BytesIO], object]) -> bytes:
    file = io.BytesIO()
    save(file)
    return file.getvalue()
