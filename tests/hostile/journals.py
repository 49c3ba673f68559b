"""A rollback journal by the file format of SQLite."""

import struct
from pathlib import Path

MAGIC = b"\xd9\xd5\x05\xf9\x20\xa1\x63\xd7"
_PAGE, _SECTOR, _NONCE = 4096, 512, 7


def journal_of_a_page(run: bytes) -> bytes:
    """A journal that restores the first page of a run as it is."""
    page = run[:_PAGE]
    check = (_NONCE + sum(page[k] for k in range(_PAGE - 200, 0, -200))) & 0xFFFFFFFF
    header = MAGIC + struct.pack(">IIIII", 1, _NONCE, len(run) // _PAGE, _SECTOR, _PAGE)
    return header.ljust(_SECTOR, b"\0") + struct.pack(">I", 1) + page + struct.pack(">I", check)


def journal_that_names(victim: Path, run: bytes) -> bytes:
    """The same as one of a set of journals. SQLite deletes the file that lists the set, which is the victim."""
    name = str(victim).encode()
    end = struct.pack(">I", 0x40000000 // _PAGE + 1) + name + struct.pack(">II", len(name), sum(name))
    return journal_of_a_page(run) + end + MAGIC
