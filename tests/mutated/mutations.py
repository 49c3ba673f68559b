"""Damages the content of a file: flipped bits, lost and repeated parts, parts of other files, extreme numbers.

``mutated`` works on bytes. What is packed (a ZIP archive, deflated MATLAB variables, cells of a database) is damaged
inside and packed again, so that most damage gets past the first check of a reader.
"""

import io
import re
import sqlite3
import struct
import zipfile
import zlib
from collections.abc import Callable
from contextlib import closing, suppress
from random import Random

from mutated.extremes import FLOATS, INTEGERS, NUMBERS, TEXTS

Mutation = Callable[[bytes, list[bytes], Random], bytes]
VALUES = (
    *FLOATS,
    *INTEGERS,
    10**400,
    *TEXTS,
    None,
    True,
    [],
    {},
    [[]],
    [1, "a", None],
    {"a": {"b": 1}},
)  # of JSON
LARGEST = 4_000_000  # bytes: no mutation makes a file larger
_NUMBER = re.compile(rb"[-+]?\d+(?:[.,]\d+)?(?:[eE][-+]?\d+)?")
_TOKEN = re.compile(rb"[\w.+-]+")
_MAT_HEADER = 128


def mutated(data: bytes, others: list[bytes], dice: Random) -> bytes:
    """One to four mutations, half of them of a text if the content is one."""
    text = b"\0" not in data[:4096]
    for _ in range(dice.choice((1, 1, 1, 2, 4))):
        data = dice.choice(_OF_TEXT if text and dice.random() < 0.7 else _OF_BYTES)(data, others, dice)
    return data[:LARGEST]


def of_archive(data: bytes, others: list[bytes], dice: Random) -> bytes:
    """One part of a ZIP archive, damaged and packed again; every fourth time, the archive itself."""
    if dice.random() < 0.25:
        return mutated(data, others, dice)
    with zipfile.ZipFile(io.BytesIO(data)) as archive:
        parts = {name: archive.read(name) for name in archive.namelist()}
    name = dice.choice(sorted(parts))
    made = io.BytesIO()
    with zipfile.ZipFile(made, "w", zipfile.ZIP_DEFLATED) as archive:
        for own, content in parts.items():
            archive.writestr(own, mutated(content, list(parts.values()), dice) if own == name else content)
    return made.getvalue()


def of_mat(data: bytes, others: list[bytes], dice: Random) -> bytes:
    """A deflated variable of a MATLAB 5 file, damaged and deflated again; every fourth time, the file itself."""
    elements, at = [], _MAT_HEADER
    while at + 8 <= len(data):
        kind, size = struct.unpack_from("<II", data, at)
        if kind != 15:  # not deflated
            break
        elements.append((at, size))
        at += 8 + size
    if not elements or dice.random() < 0.25:
        return mutated(data, others, dice)
    at, size = dice.choice(elements)
    packed = zlib.compress(mutated(zlib.decompress(data[at + 8 : at + 8 + size]), others, dice))
    return data[:at] + struct.pack("<II", 15, len(packed)) + packed + data[at + 8 + size :]


def of_database(data: bytes, others: list[bytes], dice: Random) -> bytes:
    """A few cells of an SQLite file; every third time, its bytes."""
    if dice.random() < 0.33:
        return mutated(data, others, dice)
    with closing(sqlite3.connect(":memory:", isolation_level=None)) as db, suppress(sqlite3.Error):
        db.deserialize(data)
        tables = [
            name for (name,) in db.execute("SELECT name FROM sqlite_master WHERE type = 'table' ORDER BY 1")
        ]
        for _ in range(dice.choice((1, 1, 2, 5))):
            table = dice.choice(tables)
            _change_cell(db, table, dice)
        return db.serialize()
    return data


def _change_cell(db: sqlite3.Connection, table: str, dice: Random) -> None:
    columns = [row[1] for row in db.execute(f'PRAGMA table_info("{table}")')]
    rows = [row for (row,) in db.execute(f'SELECT rowid FROM "{table}"')]
    if not rows:
        return
    row, column = dice.choice(rows), dice.choice(columns)
    (value,) = db.execute(f'SELECT "{column}" FROM "{table}" WHERE rowid = ?', (row,)).fetchone()
    new: object
    if isinstance(value, str) and dice.random() < 0.7:
        new = mutated(value.encode(), [value.encode()], dice).decode("utf-8", "replace")
    else:
        new = dice.choice(
            [*FLOATS, *(k for k in INTEGERS if abs(k) < 2**63), *TEXTS, None, b"\xff\x00", value]
        )
    some = dice.random()
    where = "rowid = ?" if some < 0.6 else "rowid >= ?" if some < 0.8 else "? IS NOT NULL"
    place = "?"
    if isinstance(new, str):  # also what is no UTF-8
        new, place = new.encode("utf-8", "surrogatepass"), "CAST(? AS TEXT)"
    if dice.random() < 0.1:
        db.execute(f'DELETE FROM "{table}" WHERE {where}', (row,))
    else:
        db.execute(f'UPDATE OR IGNORE "{table}" SET "{column}" = {place} WHERE {where}', (new, row))


def _flip(data: bytes, _: list[bytes], dice: Random) -> bytes:
    found = bytearray(data)
    for _ in range(dice.choice((1, 2, 8, 30)) if found else 0):
        found[dice.randrange(len(found))] ^= 1 << dice.randrange(8)
    return bytes(found)


def _noise(data: bytes, _: list[bytes], dice: Random) -> bytes:
    at = dice.randrange(len(data) + 1)
    length = dice.choice((1, 4, 16, 200))
    return data[:at] + dice.randbytes(length) + data[at + length :]


def _fill(data: bytes, _: list[bytes], dice: Random) -> bytes:
    at, length = dice.randrange(len(data) + 1), dice.choice((1, 4, 8, 64))
    return data[:at] + bytes([dice.choice((0, 1, 0x7F, 0x80, 0xFF))]) * length + data[at + length :]


def _cut(data: bytes, _: list[bytes], dice: Random) -> bytes:
    return data[: dice.randrange(len(data) + 1)]


def _lose(data: bytes, _: list[bytes], dice: Random) -> bytes:
    at = dice.randrange(len(data) + 1)
    return data[:at] + data[at + dice.choice((1, 2, 8, 100, 512)) :]


def _repeat(data: bytes, _: list[bytes], dice: Random) -> bytes:
    at, length = dice.randrange(len(data) + 1), dice.choice((1, 4, 8, 64, 1000))
    return data[:at] + data[at : at + length] * dice.choice((2, 3, 50)) + data[at + length :]


def _splice(data: bytes, others: list[bytes], dice: Random) -> bytes:
    other = dice.choice(others)
    at, since = dice.randrange(len(data) + 1), dice.randrange(len(other) + 1)
    length = dice.choice((8, 64, 500, len(other)))
    return data[:at] + other[since : since + length] + data[at + (length if dice.random() < 0.5 else 0) :]


def _integer(data: bytes, _: list[bytes], dice: Random) -> bytes:
    """An extreme integer in place of 1, 2, 4 or 8 bytes, of either order; often one off what is there."""
    size, order = dice.choice((1, 2, 4, 8)), dice.choice(("little", "big"))
    at = dice.randrange(max(len(data) - size, 0) + 1)
    if dice.random() < 0.4:
        value = int.from_bytes(data[at : at + size], order) + dice.choice((-1, 1, 16, 256))
    else:
        value = dice.choice(INTEGERS)
    return data[:at] + (value % 256**size).to_bytes(size, order) + data[at + size :]


def _float(data: bytes, _: list[bytes], dice: Random) -> bytes:
    at = dice.randrange(len(data) + 1) // 8 * 8
    packed = struct.pack(dice.choice("<>") + "d", dice.choice(FLOATS))
    return data[:at] + packed + data[at + 8 :]


def _other_number(data: bytes, _: list[bytes], dice: Random) -> bytes:
    return _replaced(_NUMBER, data, dice.choice(NUMBERS).encode(), dice)


def _other_text(data: bytes, _: list[bytes], dice: Random) -> bytes:
    return _replaced(_TOKEN, data, dice.choice(TEXTS).encode("utf-8", "surrogatepass"), dice)


def _replaced(pattern: re.Pattern[bytes], data: bytes, new: bytes, dice: Random) -> bytes:
    begin = dice.choice((0, dice.randrange(len(data) + 1)))  # the head of a file describes the rest
    found = list(pattern.finditer(data, begin, begin + 4000))
    if not found:
        return data
    hit = dice.choice(found)
    return data[: hit.start()] + new + data[hit.end() :]


def _lines(data: bytes, _: list[bytes], dice: Random) -> bytes:
    """Lines lost, repeated, or in another order."""
    lines = data.splitlines(keepends=True)
    if not lines:
        return data
    at, length = dice.randrange(len(lines)), dice.choice((1, 1, 3, 20))
    part, how = lines[at : at + length], dice.randrange(4)
    new = ([], part * 2, part[::-1], part * 30)[how]
    return b"".join(lines[:at] + new + lines[at + length :])


def _tokens(data: bytes, _: list[bytes], dice: Random) -> bytes:
    """Two words in each other's place."""
    found = list(_TOKEN.finditer(data[:20_000]))
    if len(found) < 2:
        return data
    one, two = sorted(dice.sample(found, 2), key=lambda hit: hit.start())
    between = data[one.end() : two.start()]
    return data[: one.start()] + two[0] + between + one[0] + data[two.end() :]


def _delimiters(data: bytes, _: list[bytes], dice: Random) -> bytes:
    """Another delimiter, somewhere or everywhere."""
    old, new = (
        dice.choice((b",", b";", b"\t", b" ", b".", b"\n", b"=", b'"', b"[", b"}")),
        dice.choice((b",", b";", b"\t", b" ", b"", b"\r", b"\n", b'"', b"\0", b":", b"{", b"]")),
    )
    return data.replace(old, new, dice.choice((1, 5, -1)))


_OF_BYTES: tuple[Mutation, ...] = (
    *(_flip, _flip, _noise, _fill, _cut, _lose, _repeat, _splice),
    *(_integer, _integer, _float),
)
_OF_TEXT: tuple[Mutation, ...] = (
    *(_other_number, _other_number, _other_text, _lines, _tokens, _delimiters),
    *(_cut, _splice),
)
