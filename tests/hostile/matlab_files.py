"""MATLAB files: damaged headers, sizes that are not there, and data that expand without end."""

import struct
import zlib

import numpy as np

from hostile.material import Material
from hostile.run_structures import Maker, content, later

HEADER = b"MATLAB 5.0".ljust(124) + struct.pack("<H", 0x100) + b"IM"


def changed(at: int, data: bytes) -> Maker:
    """The honest file with other bytes."""

    def make(m: Material, path) -> None:
        whole = bytearray((m.folder / "good.mat").read_bytes())
        whole[at : at + len(data)] = data
        path.write_bytes(whole)

    return make


def noisy(seed: int) -> Maker:
    """The honest file with twenty bytes of noise."""

    def make(m: Material, path) -> None:
        whole = bytearray((m.folder / "good.mat").read_bytes())
        dice = np.random.default_rng(seed)
        for at in dice.integers(124, len(whole), 20):
            whole[at] = dice.integers(256)
        path.write_bytes(whole)

    return make


def element(packed: bytes) -> bytes:
    """An element of deflated data."""
    return struct.pack("<II", 15, len(packed)) + packed


def zeros(size: int) -> bytes:
    """Deflated zeros, made in pieces."""
    packer, piece = zlib.compressobj(9), bytes(1_000_000)
    return b"".join(packer.compress(piece) for _ in range(size // len(piece))) + packer.flush()


def expanding(size: int, times: int) -> Maker:
    """Zeros, deflated in deflated elements."""

    def make(_: Material, path) -> None:
        packed = element(zeros(size))
        for _ in range(times - 1):
            packed = element(zlib.compress(packed, 9))
        path.write_bytes(HEADER + packed)

    return make


MATLAB: dict[str, Maker] = {
    "header only": content(HEADER),
    "half a header": content(HEADER[:60]),
    "HDF5": content(b"MATLAB 7.3 MAT-file".ljust(512) + b"\x89HDF\r\n\x1a\n"),
    "a size of 4 GB": changed(132, b"\xff\xff\xff\xff"),
    "a size of zero": changed(132, b"\0\0\0\0"),
    "unknown element": changed(128, b"\xff\0\0\0"),
    "other order": changed(126, b"MI"),
    "no order": changed(126, b"??"),
    "huge dimensions": changed(160, b"\xff\xff\xff\x7f\xff\xff\xff\x7f"),
    "negative dimensions": changed(160, b"\xff\xff\xff\xff\xff\xff\xff\xff"),
    "expands to 1 GB": expanding(1_000_000_000, 1),
    "deflated in itself": expanding(100_000_000, 3),
    "damaged deflate": content(HEADER + struct.pack("<II", 15, 1000) + b"x" * 1000),
    "100 000 elements": later(lambda: content(HEADER + element(zlib.compress(b"")) * 100_000)),
    **{f"noise {seed}": noisy(seed) for seed in range(8)},
}
