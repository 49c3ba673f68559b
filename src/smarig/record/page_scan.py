"""Reads the rows out of the pages of a damaged SQLite file, without its schema, its trees and its indexes.

Each page of a tree names its own rows, so a page that is lost takes only its rows along. The format of the pages is
that of https://sqlite.org/fileformat2.html. Nothing in the file is trusted: what does not decode is no row.
"""

import errno
import os
import struct
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

_PAGE_SIZES = [2**k for k in range(9, 17)]
_PAGE_SIZE = 4096  # if the file does not tell
_HEADER_BYTES = 100  # of the file, in its first page
_TABLE_LEAF, _INDEX_LEAF, _INDEX_INTERIOR = 0x0D, 0x0A, 0x02
_INTEGER_BYTES = {1: 1, 2: 2, 3: 3, 4: 4, 5: 6, 6: 8}  # by serial type
_FIXED = {0: None, 8: 0, 9: 1}
_PAGES_PER_LOOK = 1000  # for holes of the file
_OVERFLOW_SHARE = 2  # times the size of the file: more than that is read only in a file made to keep us busy


@dataclass(frozen=True)
class ScannedRow:
    """A row that a page holds: cells as stored, and its rowid if it is the row of a table with rowids."""

    rowid: int | None
    cells: tuple[Any, ...]


class PageScan:
    """The pages of a file. ``unreadable`` counts, after ``rows``, those that the disk did not give."""

    def __init__(self, file: Path) -> None:
        self._file = file
        self.unreadable = 0
        self._handle = -1
        self._page_size = _PAGE_SIZE
        self._usable = _PAGE_SIZE
        self._overflow_bytes = 0  # that may still be read

    def rows(self) -> Iterator[ScannedRow]:
        """All rows in the order of the pages. A file that cannot be opened raises OSError."""
        self._handle = os.open(self._file, os.O_RDONLY | getattr(os, "O_BINARY", 0))
        try:
            size = self._find_page_size()
            pages = -(-size // self._page_size)
            self._overflow_bytes = _OVERFLOW_SHARE * size
            unused = set(self._unused_pages())
            for number in self._stored_pages(pages):
                if number not in unused:
                    yield from self._rows_of(number)
        finally:
            os.close(self._handle)

    def _stored_pages(self, pages: int) -> Iterator[int]:
        """Numbers of the pages, without the holes of a sparse file, which may be longer than any disk."""
        number = 1
        while number <= pages:
            if number % _PAGES_PER_LOOK == 1 and hasattr(os, "SEEK_DATA"):
                try:
                    stored = os.lseek(self._handle, (number - 1) * self._page_size, os.SEEK_DATA)
                except OSError as error:
                    if error.errno == errno.ENXIO:
                        return
                    stored = 0  # a disk that cannot tell
                number = max(number, stored // self._page_size + 1)
            yield number
            number += 1

    def _find_page_size(self) -> int:
        """Find the size of a page; returns that of the file."""
        header = self._read(0, _HEADER_BYTES)
        size = int.from_bytes(header[16:18], "big")
        size = 65536 if size == 1 else size
        self._page_size = size if size in _PAGE_SIZES else _PAGE_SIZE
        reserved = header[20] if len(header) > 20 else 0
        self._usable = self._page_size - (reserved if reserved <= 32 else 0)
        return os.fstat(self._handle).st_size

    def _read(self, offset: int, count: int) -> bytes:
        try:
            os.lseek(self._handle, offset, os.SEEK_SET)
            return os.read(self._handle, count)
        except OSError:
            return b""

    def _page(self, number: int) -> bytes:
        return self._read((number - 1) * self._page_size, self._page_size)

    def _unused_pages(self) -> Iterator[int]:
        """Pages of the free list: what they hold was deleted."""
        trunk, seen = int.from_bytes(self._read(32, 4), "big"), set()
        while trunk and trunk not in seen:
            seen.add(trunk)
            page = self._page(trunk)
            if len(page) < self._page_size or page[0] in (_TABLE_LEAF, _INDEX_LEAF, _INDEX_INTERIOR):
                return
            yield trunk
            following, count = struct.unpack_from(">II", page)
            leaves = min(count, self._usable // 4 - 2)
            yield from struct.unpack_from(f">{leaves}I", page, 8)
            trunk = following

    def _rows_of(self, number: int) -> Iterator[ScannedRow]:
        page = self._page(number)
        start = _HEADER_BYTES if number == 1 else 0
        if len(page) < start + 8:
            self.unreadable += 1
            return
        kind = page[start]
        if kind not in (_TABLE_LEAF, _INDEX_LEAF, _INDEX_INTERIOR):
            return
        count = int.from_bytes(page[start + 3 : start + 5], "big")
        pointers = start + (12 if kind == _INDEX_INTERIOR else 8)
        for k in range(min(count, (len(page) - pointers) // 2)):
            place = int.from_bytes(page[pointers + 2 * k : pointers + 2 * k + 2], "big")
            row = self._row(page, kind, place)
            if row is not None:
                yield row

    def _row(self, page: bytes, kind: int, place: int) -> ScannedRow | None:
        try:
            if kind == _INDEX_INTERIOR:
                place += 4
            size, place = _varint(page, place)
            rowid = None
            if kind == _TABLE_LEAF:
                rowid, place = _varint(page, place)
            return ScannedRow(rowid, _cells(self._payload(page, kind, size, place)))
        except (IndexError, ValueError, struct.error):
            return None

    def _payload(self, page: bytes, kind: int, size: int, place: int) -> bytes:
        """The bytes of a record, with those on overflow pages."""
        usable = self._usable
        most = usable - 35 if kind == _TABLE_LEAF else (usable - 12) * 64 // 255 - 23
        if size <= most:
            return page[place : place + size]
        least = (usable - 12) * 32 // 255 - 23
        local = least + (size - least) % (usable - 4)
        local = local if local <= most else least
        parts, left = [page[place : place + local]], size - local
        self._overflow_bytes -= max(left, 0)
        if self._overflow_bytes < 0:
            raise ValueError
        following = int.from_bytes(page[place + local : place + local + 4], "big")
        while left > 0 and following:
            more = self._page(following)
            parts.append(more[4 : min(usable, left + 4)])
            if len(parts[-1]) == 0:
                raise ValueError
            left -= len(parts[-1])
            following = int.from_bytes(more[:4], "big")
        return b"".join(parts)


def _varint(data: bytes, place: int) -> tuple[int, int]:
    """A number of 1 to 9 bytes, and the place after it."""
    value = 0
    for k in range(8):
        byte = data[place + k]
        value = value << 7 | byte & 0x7F
        if byte < 0x80:
            return value, place + k + 1
    value = value << 8 | data[place + 8]
    return value - 2**64 if value >= 2**63 else value, place + 9


def _cells(record: bytes) -> tuple[Any, ...]:
    """The cells of a record. Raises ValueError or IndexError if it is none."""
    header, place = _varint(record, 0)
    kinds = []
    while place < header:
        kind, place = _varint(record, place)
        kinds.append(kind)
    if place != header:
        raise ValueError
    cells = []
    for kind in kinds:
        value, place = _cell(record, kind, place)
        cells.append(value)
    if place != len(record):
        raise ValueError
    return tuple(cells)


def _cell(record: bytes, kind: int, place: int) -> tuple[Any, int]:
    if kind in _FIXED:
        return _FIXED[kind], place
    if kind in _INTEGER_BYTES:
        end = place + _INTEGER_BYTES[kind]
        return int.from_bytes(record[place:end], "big", signed=True), end
    if kind == 7:
        return struct.unpack_from(">d", record, place)[0], place + 8
    if kind < 12:
        raise ValueError
    end = place + (kind - 12) // 2
    content = record[place:end]
    return (content.decode("utf-8") if kind % 2 else content), end
