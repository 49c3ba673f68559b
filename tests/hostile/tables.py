"""Text tables of many dialects, of absurd sizes, and of numbers that only Python takes for numbers."""

import numpy as np

from hostile.material import CSV
from hostile.run_structures import Maker, later

HEAD = "time_s,current_command_A,position_mm\n"


def text(content: str, encoding: str = "utf-8") -> Maker:
    """A file of this text."""
    return lambda _, path: path.write_bytes(content.encode(encoding, "surrogatepass"))


def cell(value: str) -> Maker:
    """A table with one hostile cell."""
    return text(CSV + f"7.0,0.5,{value}\n7.1,0.5,1\n")


def wide(columns: int) -> Maker:
    """A table of many columns."""
    names = "," + ",".join(f"c{k}" for k in range(columns)) if columns else ""
    return text(HEAD.strip() + names + "\n" + ("0,0,0" + ",1" * columns + "\n") * 2)


TABLES: dict[str, Maker] = {
    "field of 200 000": later(lambda: cell('"' + "x" * 200_000 + '"')),
    "header of 200 000": later(lambda: text('"' + "x" * 200_000 + '",' + CSV)),
    "open quote": cell('"1'),
    "quote over lines": cell('"1\n2\n3"'),
    "200 000 columns": later(lambda: wide(200_000)),
    "a million commas": later(lambda: text(CSV + "," * 1_000_000 + "\n")),
    "a million empty names": later(lambda: text("," * 1_000_000 + "\n" + CSV)),
    "the same name twice": text(CSV.replace("position_mm", "time_s,position_mm", 1)),
    "a line of 20 MB": later(lambda: text(CSV + "1" * 20_000_000 + "\n")),
    "a digit of 5 MB": later(lambda: cell("9" * 5_000_000)),
    "two million blank lines": later(lambda: text("\n" * 2_000_000 + CSV)),
    "two million lines of spaces": later(lambda: text(CSV + " \n" * 2_000_000)),
    "underscores": cell("1_000"),
    "full-width digits": cell("１２"),
    "Arabic digits": cell("١٢"),
    "infinity in words": cell("infinity"),
    "infinity": cell("1e999"),
    "not a number": cell("-nan"),
    "hexadecimal": cell("0x10"),
    "a comma for a point": cell('"1,5"'),
    "thousands": cell('"1,000.5"'),
    "Unicode minus": cell("−1"),
    "no-break space": cell("\u00a01"),
    "direction marks": cell("\u202e1"),
    "formula": cell("=1+1"),
    "formula as a name": text(CSV.replace("position_mm", "=cmd|calc!A0", 1)),
    "zero bytes": text(CSV + "\x00\x00\n"),
    "bytes of no text": lambda _, path: path.write_bytes(CSV.encode() + b"\xff\xfe\xfd\n"),
    "half UTF-16": lambda _, path: path.write_bytes(CSV.encode("utf-16")[:-1]),
    "UTF-32": text(CSV, "utf-32"),
    "surrogates": text(CSV + "\ud800,0,0\n"),
    "carriage returns": text(CSV.replace("\n", "\r")),
    "other line ends": text(CSV.replace("\n", "\u2028")),
    "form feeds": text(CSV.replace("\n", "\n\x0c")),
    "only a header": text(HEAD),
    "nothing": text(""),
    "blanks": text(" \n \n"),
    "only quotes": later(lambda: text('"' * 100_000)),
    "mixed delimiters": text(CSV.replace(",", ";", 30)),
    "semicolons and commas": text(CSV.replace(",", ";").replace(".", ",")),
    "time runs back": text(CSV + "1,0,0\n"),
    "huge time": text(HEAD + "".join(f"{k}e300,0,{k}\n" for k in range(50))),
    "huge positions": text(HEAD + "".join(f"{k},0.{k % 2},{(-1) ** k}e308\n" for k in range(50))),
    "tiny numbers": text(HEAD + "".join(f"{k},{k}e-320,{k}e-320\n" for k in range(50))),
    "steps beyond all": text(
        HEAD.replace("\n", ",step\n") + "".join(f"{k},0,{k},{k}e300\n" for k in range(50))
    ),
    "flags beyond all": text(
        HEAD.replace("\n", ",flags\n") + "".join(f"{k},0,{k},1e300\n" for k in range(50))
    ),
    "noise": lambda _, path: path.write_bytes(np.random.default_rng(5).bytes(10_000)),
    "printable noise": lambda _, path: path.write_bytes(
        np.random.default_rng(6).integers(32, 127, 50_000).astype(np.uint8).tobytes()
    ),
    "endless device": lambda _, path: path.symlink_to("/dev/zero"),
    "reference": later(lambda: text("time_s,position_mm\n" + '0,"' + "1" * 200_000 + '"\n')),
    "reference in full width": text("time_s,position_mm\n0,１\n5,1_0\n"),
    "profile": later(lambda: text("temperature_K\n" + '"' + "x" * 200_000 + '"\n')),
    "profile of underscores": text("temperature_K\n1_0\n２０\n"),
    "FORC of long lines": later(
        lambda: text("MicroMag 2900\nHCal = " + "1" * 100_000 + "\n" + "1," * 100_000 + "\n")
    ),
    "FORC of a key": text(
        "MicroMag 2900\n" + "a " * 50_000 + "\nUnits of measure  SI\n\n"
        "+1,+2\n\n0,1\n1,2\n\n0.5,1\n1,2\n\nMicroMag 2900 Data File ends\n"
    ),
    "FORC of huge numbers": text(
        "MicroMag 2900\nUnits of measure  SI\nHCal  1_0\nNData  inf\nNCrv  nan\nMoment range  1e999\n\n"
        "+1e308,+1e308\n\n-1e308,1\n1e308,2\n\n-1e308,1\n1e400,2\n\nMicroMag 2900 Data File ends\n"
    ),
}
