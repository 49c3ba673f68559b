"""Every kind of file that smarig reads: its seeds, how a file of it is damaged, and what is done with it."""

import json
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from random import Random

from hostile.material import make_material
from mutated import mutations
from mutated.hdf5_files import hdf5s, matlab_73s
from mutated.table_formats import forc, matlabs, own_csvs, parquets, tdmss, texts, workbooks
from smarig.config import load_actuator, load_campaign, load_rig
from smarig.exchange import find_tables, import_file, load_mapping
from smarig.plant import Actuator
from smarig.record import SAMPLE_COLUMNS, load_run
from smarig.replay import load_model
from smarig.study import StudyOptions, mapping_draft, understand

CONFIGS = Path(__file__).parents[2] / "configs"
Opener = Callable[[Path], object]


@dataclass(frozen=True)
class Format:
    """``seeds``: contents of honest files; ``open``: what smarig does with a file of this format."""

    name: str
    ending: str
    seeds: Callable[[Path], list[bytes]]
    open: Opener
    mutate: mutations.Mutation = mutations.mutated

    def mutation(self, seeds: list[bytes], number: int) -> bytes:
        """Mutation ``number`` of the seeds: always the same one."""
        dice = Random(f"{self.name} {number}")
        return self.mutate(dice.choice(seeds), seeds, dice)


def _study(path: Path) -> None:
    """As ``smarig study``: find the tables, guess their meaning, and import the first through the draft."""
    understood = understand([path], StudyOptions(accept=True))
    guess = understood.guesses[0]
    mapping = None
    if guess.table.format != "forc":
        mapping = path.with_name("mapping.toml")
        mapping.write_text(mapping_draft(guess, "draft"), encoding="utf-8")
    out = path.with_name("out.run.sqlite")
    import_file(path, format=guess.table.format, mapping=mapping and str(mapping), out=out, force=True)


def _own_csv(path: Path) -> None:
    rig = "one_wire_twin" if b"counts" in path.read_bytes() else None
    import_file(path, format="csv", rig=rig, out=path.with_name("out.run.sqlite"), repair=True, force=True)


def _forc(path: Path) -> None:
    find_tables(path)
    import_file(path, format="forc", out=path.with_name("out.run.sqlite"), force=True)


def _run(path: Path) -> None:
    run = load_run(path)
    for name in SAMPLE_COLUMNS:
        run.has(name)
    for step in run.steps:
        run.rows(step)
    repr(run)


def _model(path: Path) -> None:
    model = load_model(path)
    h = model.hysteresis
    model.predict([h.lower, h.upper, (h.lower + h.upper) / 2])
    repr(model)


def _material(name: str) -> Callable[[Path], list[bytes]]:
    def read(folder: Path) -> list[bytes]:
        if not (folder / name).exists():
            make_material(folder)
        return [(folder / name).read_bytes()]

    return read


def _configs(kind: str) -> Callable[[Path], list[bytes]]:
    return lambda _: [path.read_bytes() for path in sorted((CONFIGS / kind).glob("*.toml"))]


def _actuator(path: Path) -> None:
    load_actuator(str(path))
    Actuator.named(str(path))


def _model_json(data: bytes, others: list[bytes], dice: Random) -> bytes:
    """A value of the tree, or the text."""
    if dice.random() < 0.5:
        return mutations.mutated(data, others, dice)
    whole = json.loads(data)
    node, where = whole, None
    while isinstance(node, dict | list) and node and (where is None or dice.random() < 0.85):
        parent = node
        where = dice.choice(sorted(node) if isinstance(node, dict) else range(len(node)))
        node = node[where]
    parent[where] = dice.choice(mutations.VALUES)
    return json.dumps(whole).encode()


FORMATS = {
    f.name: f
    for f in (
        Format("text", ".csv", lambda _: texts(), _study),
        Format("own csv", ".csv", lambda _: own_csvs(), _own_csv),
        Format("forc", ".frc", lambda _: forc(), _forc),
        Format("xlsx", ".xlsx", lambda _: workbooks(), _study, mutations.of_archive),
        Format("parquet", ".parquet", lambda _: parquets(), _study),
        Format("tdms", ".tdms", lambda _: tdmss(), _study),
        Format("mat 5", ".mat", lambda _: matlabs(), _study, mutations.of_mat),
        Format("mat 7.3", ".mat", lambda _: matlab_73s(), _study),
        Format("hdf5", ".h5", lambda _: hdf5s(), _study),
        Format("run", ".run.sqlite", _material("killed.run.sqlite"), _run, mutations.of_database),
        Format("model", ".model.json", _material("m.model.json"), _model, _model_json),
        Format("rig", ".toml", _configs("rigs"), lambda path: load_rig(str(path))),
        Format("actuator", ".toml", _configs("actuators"), _actuator),
        Format("campaign", ".toml", _configs("campaigns"), lambda path: load_campaign(str(path))),
        Format("mapping", ".toml", _configs("imports"), lambda path: load_mapping(str(path))),
    )
}
