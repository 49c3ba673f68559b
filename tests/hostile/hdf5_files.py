"""HDF5 files whose data lie elsewhere, or whose sizes, filters, types and links are not what they seem.

They are written by h5py where it can, and bytes are changed where it refuses.
"""

import os
import zlib
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

from hostile.material import SECRET, Material
from hostile.run_structures import Maker, content

ROWS = 60
Fill = Callable[[Any, Material, Path], object]
DEFLATE, PLUG_IN = (
    1,
    32015,
)  # numbers of filters; the second is that of a library (Zstandard) that HDF5 would load
_LARGE = 10**12


def file(fill: Fill, libver: str = "earliest") -> Maker:
    """Two honest columns of the import's mapping, and what ``fill`` adds."""

    def make(m: Material, path: Path) -> None:
        import h5py

        with h5py.File(path, "w", libver=libver) as made:
            made["H"] = np.linspace(0, 100, ROWS)
            made["B"] = np.sin(np.linspace(0, 6, ROWS))
            fill(made, m, path)

    return make


def external(place: Callable[[Material, Path], Path], size: int = 8 * ROWS) -> Fill:
    """A data set whose bytes are those of another file."""
    return lambda made, m, path: made.create_dataset(
        "H2", (size // 8,), "f8", external=[(str(place(m, path)), 0, size)]
    )


def _secret(m: Material, path: Path) -> Path:
    path.with_name("secret.bin").write_bytes((SECRET * 100).encode())
    return path.with_name("secret.bin")


def _fifo(_: Material, path: Path) -> Path:
    os.mkfifo(path.with_name("pipe"))
    return path.with_name("pipe")


def _virtual(made: Any, m: Material, path: Path) -> None:
    import h5py

    with h5py.File(path.with_name("other.h5"), "w") as other:
        other["x"] = np.frombuffer((SECRET * 100).encode()[: 8 * ROWS], "f8")
    layout = h5py.VirtualLayout((ROWS,), "f8")
    layout[:] = h5py.VirtualSource(str(path.with_name("other.h5")), "x", (ROWS,))
    made.create_virtual_dataset("H2", layout)


def _linked(made: Any, m: Material, path: Path) -> None:
    import h5py

    with h5py.File(path.with_name("other.h5"), "w") as other:
        other["x"] = np.arange(float(ROWS))
    made["H2"] = h5py.ExternalLink(str(path.with_name("other.h5")), "x")


def _soft(made: Any, *_: object) -> None:
    import h5py

    made["round"], made["nowhere"] = h5py.SoftLink("/"), h5py.SoftLink("/not/there")


def _hard_loop(made: Any, *_: object) -> None:
    made["inner"] = made["/"]


def _plugged(number: int) -> Fill:
    def fill(made: Any, *_: object) -> None:
        import h5py

        plan = h5py.h5p.create(h5py.h5p.DATASET_CREATE)
        plan.set_chunk((ROWS,))
        plan.set_filter(number, h5py.h5z.FLAG_OPTIONAL, (1, 2, 3))
        space = h5py.h5s.create_simple((ROWS,))
        kind = h5py.h5t.NATIVE_DOUBLE
        made_set = h5py.h5d.create(made.id, b"H2", kind, space, plan)
        made_set.write_direct_chunk((0,), np.arange(float(ROWS)).tobytes())

    return fill


def _sparse(made: Any, *_: object) -> None:
    made.create_dataset("H2", (_LARGE,), "f8", chunks=(1000,), compression="gzip")


def _sparse_many(made: Any, *_: object) -> None:
    for k in range(150):
        made.create_dataset(f"x{k}", (40_000_000,), "f8", chunks=(100_000,), compression="gzip")


def _bomb(made: Any, *_: object) -> None:
    for k in range(12):
        made.create_dataset(f"x{k}", data=np.zeros(10_000_000), chunks=True, compression="gzip")


def _one_chunk(made: Any, *_: object) -> None:
    made.create_dataset("H2", (ROWS,), "f8", chunks=(400_000_000,), maxshape=(None,), compression="gzip")
    made["H2"].id.write_direct_chunk((0,), zlib.compress(bytes(1000)))


def _long_texts(made: Any, *_: object) -> None:
    made["H"].attrs["units"] = "m" * 60_000
    made["H"].attrs["unit"] = b"\xff\xfe" * 100
    made.attrs["note"] = "n" * 60_000


def _odd_names(made: Any, *_: object) -> None:
    made["\x1b[2J"], made["=cmd|calc!A0"] = np.arange(float(ROWS)), np.arange(float(ROWS))
    made.create_dataset(b"\xff\xfe", data=np.arange(float(ROWS)))


def _deep(made: Any, *_: object) -> None:
    for _ in range(3000):
        made = made.create_group("g")
    made["x"], made["y"] = np.arange(5.0), np.arange(5.0)


def _references(made: Any, *_: object) -> None:
    import h5py

    made.create_dataset("links", data=[made["H"].ref] * ROWS, dtype=h5py.ref_dtype)
    regions = made.create_dataset("regions", (ROWS,), h5py.regionref_dtype)
    regions[0] = made["H"].regionref[1:5]


def _many_attributes(made: Any, *_: object) -> None:
    for k in range(3000):
        made["H"].attrs[f"a{k}"] = "x" * 20


def _wide(made: Any, *_: object) -> None:
    made["matrix"], made["turned"] = np.zeros((ROWS, 5000)), np.zeros((5000, ROWS))
    made["cube"] = np.zeros((3,) * 12)


def _numbers(made: Any, *_: object) -> None:
    made["H2"] = np.tile([1e308, -1e308, np.nan, np.inf, 5e-324], ROWS // 5)
    made["long"] = np.full(ROWS, 10, np.longdouble)
    made["wide"] = np.full(ROWS, 2**64 - 1, np.uint64)


def changed(at: int, data: bytes) -> Maker:
    """The honest columns with other bytes."""

    def make(m: Material, path: Path) -> None:
        file(lambda *_: None)(m, path)
        whole = bytearray(path.read_bytes())
        whole[at : at + len(data)] = data
        path.write_bytes(whole)

    return make


def noisy(seed: int, libver: str) -> Maker:
    """The honest columns with forty bytes of noise in what describes them."""

    def make(m: Material, path: Path) -> None:
        file(lambda *_: None, libver)(m, path)
        whole = bytearray(path.read_bytes())
        dice = np.random.default_rng(seed)
        for at in dice.integers(8, len(whole) - 2 * 8 * ROWS, 40):
            whole[at] = dice.integers(256)
        path.write_bytes(whole)

    return make


HDF5: dict[str, Maker] = {
    "data in a secret file": file(external(_secret)),
    "data in a secret file, new metadata": file(external(_secret), "latest"),
    "data in a relative secret file": file(external(lambda m, p: Path(_secret(m, p).name))),
    "data in /etc/passwd": file(external(lambda *_: Path("/etc/passwd"), 480)),
    "data in a pipe": file(external(_fifo)),
    "data in an endless device": file(external(lambda *_: Path("/dev/zero"), 480)),
    "data in a missing file": file(external(lambda _, p: p.with_name("not there"))),
    "virtual data of a secret file": file(_virtual, "latest"),
    "link to another file": file(_linked),
    "soft links": file(_soft),
    "a group within itself": file(_hard_loop),
    "filter of a plug-in": file(_plugged(PLUG_IN)),
    "filter of nobody": file(_plugged(60_000)),
    "damaged by its own filter": file(_plugged(DEFLATE)),
    "1 T values": file(_sparse),
    "48 GB of nothing": file(_sparse_many),
    "expands to 960 MB": file(_bomb),
    "a chunk of 3 GB": file(_one_chunk),
    "long texts": file(_long_texts),
    "odd names": file(_odd_names),
    "3000 groups within each other": file(_deep),
    "references": file(_references),
    "3000 attributes": file(_many_attributes, "latest"),
    "wide matrices": file(_wide),
    "numbers beyond all": file(_numbers),
    "no size": changed(40, b"\xff" * 8),
    "superblock of another version": changed(8, b"\x07"),
    "a signature alone": content(b"\x89HDF\r\n\x1a\n" + b"\0" * 2000),
    "MATLAB 7.3 of nothing": content(b"MATLAB 7.3 MAT-file".ljust(512) + b"\x89HDF\r\n\x1a\n"),
    "endless device": lambda _, path: path.symlink_to("/dev/zero"),
    "a pipe": lambda _, path: os.mkfifo(path),
    **{f"noise {seed}": noisy(seed, ("earliest", "latest")[seed % 2]) for seed in range(10)},
}
