"""What is in the files: the tables of a run, the keys of a model."""

import re
import sqlite3
from collections.abc import Iterator

from pydantic import BaseModel

from generate.comments import tuple_comments
from generate.markdown import code, plain, table
from smarig.config import class_comments, inner_model, type_text, unit_of
from smarig.core import Quality
from smarig.preisach.hysteresis import hysteresis_json
from smarig.record import schema
from smarig.replay import model_file

RUN = """# Run file

A run is one SQLite file, `*.run.sqlite`. It is written during the run; a power cut loses at most a second of samples.
`smarig.load_run` reads it, and so does any program that reads SQLite. All other formats (CSV, NetCDF, …) are derived
from it.

When a run is closed, a hash of each table is stored, and `load_run` compares it: a file in which a value has changed
is refused. `smarig check RUN` says what such a file holds, and with `-o FILE` saves what can be saved to a new file. A
hash is the first 16 digits of the SHA-256 of up to 1000 rows; `smarig.record.table_hashes` documents their bytes. A
program that changes a run file must also remove the key `hashes`, and `hashed` from `end`.
"""
RUN_KEYS = {
    "schema_version": "of these tables",
    "rig": "name of the rig",
    "config": "text of the rig file, followed by those of its base files",
    "actuator": "name of the actuator",
    "actuator_text": "text of the actuator file",
    "rig_values": "every value of the rig, with those of its base files and defaults",
    "actuator_values": "every value of the actuator",
    "rig_sha256": "SHA-256 hashes of the four keys above; of values, as JSON with sorted keys and no spaces",
    "has_lease": "false: the current source does not switch itself off when the host fails",
    "wire": "identity of the wire",
    "wire_history": "history of the wire before the run",
    "source": "origin of the data: bench, twin, simulation or import",
    "protocol": "name of the protocol",
    "settings": "its settings",
    "own_files": "protocols, controllers, effects and drivers given by path, and plug-ins, with their hashes",
    "seed": "of the twin's noise",
    "effects": "injected in the twin",
    "input": "quantity and unit of the column `input`, and where it comes from",
    "output": "quantity and unit of the column `position`; `per_count` is one count of the encoder",
    "initial": "state of the hysteresis at the first sample",
    "period_s": "length of a tick",
    "start_epoch": "seconds since 1970 at tick 0; a label only, because time is counted in ticks",
    "encoder_zero": "where the encoder was zeroed; with the epoch it distinguishes sessions; absolute: that of this "
    "sensor, in all sessions; own: an arbitrary zero",
    "device": "identities and boot counts of the devices",
    "shift": "ticks and counts between the devices' zeros and the run's, where it was resumed",
    "recorder_pid": "process that wrote it",
    "history_until_tick": "last tick whose samples the wire's history contains",
    "versions": "versions of smarig and of its numerical libraries",
    "notes": "a remark",
    "begun_with": "what `smarig resume` needs to build the same run",
    "end": "cause and time, and whether hashes were stored; missing if the run was never closed",
    "hashes": "of each table, a hash of every 1000 rows as they were when the run was closed, and the first tick of "
    "each block of samples",
    "salvaged": "in a file that `smarig check RUN -o FILE` wrote: from which file, and the missing and doubtful ticks",
    "model": "simulation: name of the model",
    "along": "simulation: the run whose inputs the model followed",
    "imported": "import: the file, its hash, its mapping",
    "conditions": "values that runs are compared by, with mean, min and max: the load of a rig's wire and its stress; "
    "import: those that the mapping keeps in addition to the channels",
    "load": "of a rig with one wire: the force in N, or its formula or knots over time, and the section of the wire",
    "repairs": "import with --repair: by kind, the rows that were masked or dropped",
    "header": "import: the header of the table that was read, in files of several",
    "t0_s": "import: --t0",
    "warnings": "import: everything that looked wrong",
}
QUALITY = {
    "GOOD": "no remark",
    "RETRIED": "an exchange had to be repeated",
    "STALE": "the value is an older one",
    "SATURATED": "the amplifier was at its limit",
    "TRIPPED": "the device had switched itself off",
    "SUSPECT": "the reading contradicts the order, the wire or another reading",
}
MODEL = """# Model file

A model is one JSON file, `*.model.json`, in readable text. `smarig.load_model` reads and checks it; an unknown key is
an error. A figure that is not known is `null`.
"""


def pages() -> dict[str, str]:
    """Two pages."""
    return {"run_file": _run_file(), "model_file": _model_file()}


def columns() -> dict[str, dict[str, str]]:
    """Comments on the columns of the tables that have a list of them."""
    names = {"sample": "SAMPLE_COLUMNS", "step": "STEP_COLUMNS", "event": "EVENT_COLUMNS"}
    return {name: tuple_comments(schema, where) for name, where in names.items()}


def models(
    model: type[BaseModel] = model_file._ModelFileSchema, where: str = ""
) -> Iterator[tuple[str, type[BaseModel]]]:
    """(place, model) of a model file and of the objects in it."""
    yield where, model
    for name, field in model.model_fields.items():
        inner, is_list = inner_model(field.annotation)
        if inner is not None:
            yield from models(inner, f"{name}[]" if is_list else name)


def _run_file() -> str:
    parts = [RUN]
    lead = {
        "sample": "One row a tick. A channel that was not measured is NULL.",
        "step": "One row a step of the protocol.",
        "event": "What happened, with a sentence. The level implies a severity (none, minor, major); another one is in "
        "`data` under `severity`, and that may be `invalid`: values are missing, or cannot be trusted.",
    }
    for name, comments_by_name in columns().items():
        rows = [(code(c), kind, unit_of(c), plain(comments_by_name.get(c, ""))) for c, kind in _created(name)]
        parts.append(f"## `{name}`\n\n{lead[name]}\n\n{table(('column', 'type', 'unit', 'means'), rows)}")
        if name == "sample":
            marks = [(str(int(Quality[n])), n, means) for n, means in QUALITY.items()]
            parts.append(f"Marks of `quality`, added up:\n\n{table(('mark', 'name', 'means'), marks)}")
    rows = [(code(key), means) for key, means in RUN_KEYS.items()]
    parts.append(f"## `run`\n\nKey and value; values are JSON.\n\n{table(('key', 'means'), rows)}")
    return "\n".join(parts)


def _created(name: str) -> list[tuple[str, str]]:
    """(column, SQLite's type) as the table is created."""
    with sqlite3.connect(":memory:") as db:
        db.executescript(schema.CREATE)
        found = [(row[1], row[2].lower()) for row in db.execute(f'PRAGMA table_info("{name}")')]
    db.close()
    return found


def _model_file() -> str:
    parts = [MODEL]
    for where, model in models():
        comments_by_name = class_comments(model)
        rows = [
            (code(n), type_text(f.annotation), plain(comments_by_name.get(n, "")))
            for n, f in model.model_fields.items()
        ]
        head = f"## `{where}`\n\n" if where else ""
        parts.append(head + table(("key", "type", "means"), rows))
    parts.append("## `hysteresis`\n\n" + table(("kind", "class"), [(code(k), code(c)) for k, c in _kinds()]))
    return "\n".join(parts)


def _kinds() -> list[tuple[str, str]]:
    """What ``dump_hysteresis`` can write: the name of the kind, and its class."""
    written = {
        re.sub(r"(?<!^)(?=[A-Z])", "_", kind.__name__).lower(): f"{kind.__module__}.{kind.__name__}"
        for kind in hysteresis_json.dump_hysteresis.registry
    }
    return [(name, written[name]) for name in hysteresis_json._LOADERS]
