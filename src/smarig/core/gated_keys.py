"""The table of the gate: every key of a file that can lead to a path, a program, another file, a formula, an address.

The page docs/explanation/safety.md shows it; ``tests/gate`` walks it key by key with crafted files.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from enum import IntEnum


class Origin(IntEnum):
    """Who named a text, from the least trusted on. What a file of the user names in turn is the user's too."""

    INSIDE = 0
    """A file that came inside another, or that a person did not write: record, model, queue, container, folder."""
    FILE = 1
    """A configuration file that the user named."""
    USER = 2
    """The user's own command line, click, or call in Python."""


@dataclass(frozen=True)
class GatedKey:
    """A key that leads somewhere: ``place`` (the kind of file), ``key``, and what it leads to.

    ``least``: the least trusted origin that may name it; None for nobody. ``sentence``: the refusal, with {where} for
    the file, {text} for what it names, and {again} for the same as a word of a command; for keys that are never
    followed, what happens instead.
    """

    place: str
    key: str
    leads_to: str
    least: Origin | None
    sentence: str

    @property
    def name(self) -> str:
        """Its name in the table.

        >>> GATED_KEYS["rig: simulator.library"].name
        'rig: simulator.library'
        """
        return f"{self.place}: {self.key}"


_TRUST = "If you trust it, name it yourself: "
_ANY, _FILE, _USER, _NOBODY = Origin.INSIDE, Origin.FILE, Origin.USER, None
_IN_A_RECORD = "{where} holds a rig that names {text}, which is not used: a record is only compared."


def _rows() -> Iterator[GatedKey]:
    yield from _run_rows()
    yield from _model_rows()
    yield from _configuration_rows()
    yield from _data_rows()
    yield from _console_rows()


def _run_rows() -> Iterator[GatedKey]:
    yield GatedKey(
        "run",
        "begun_with.rig",
        "rig file, and with it drivers, libraries, other files",
        _USER,
        "{where} names the rig file {text}, which is not read, because a record may come from anywhere. "
        "If you trust it, smarig resume {where} --rig {again} reads it.",
    )
    yield GatedKey(
        "run",
        "begun_with.load",
        "CSV file, formula",
        _USER,
        "{where} was made with the load {text}, which would be read. A load that changes over time cannot be taken up "
        "again. Start the run again: smarig run … --load LOAD.",
    )
    yield GatedKey(
        "run",
        "begun_with.effects",
        "own Python file, plug-in",
        _USER,
        "{where} was made with the effect {text}. " + _TRUST + "smarig resume {where} --effect FILE.py.",
    )
    yield GatedKey(
        "run",
        "settings.file",
        "CSV file",
        _USER,
        "{where} was made with the file {text}, which would be read. To allow this, give it again: "
        "smarig resume {where} --set file=FILE.",
    )
    yield GatedKey(
        "run",
        "protocol",
        "own Python file, plug-in",
        _USER,
        "{where} was made with the protocol {text}. " + _TRUST + "smarig resume {where} --protocol FILE.py.",
    )
    yield GatedKey(
        "run",
        "rig",
        "rig file",
        _USER,
        "{where} names the rig {text}, which is not a rig of smarig. " + _TRUST + "--rig RIG.",
    )
    yield GatedKey(
        "run",
        "actuator",
        "actuator file",
        _USER,
        "{where} names the actuator {text}, which is not one of smarig. Its path is not followed, because a record may "
        "come from anywhere; a file of this name is looked for beside the run and in the folder above. Put it there.",
    )
    yield GatedKey("run", "config, rig_values, actuator_values", "what a rig can name", _NOBODY, _IN_A_RECORD)
    yield GatedKey(
        "run",
        "own_files, along, model, imported, companions",
        "path",
        _NOBODY,
        "Shown as words; the file is not opened. An own file is given again, and its hash compared.",
    )
    yield GatedKey(
        "run",
        "wire",
        "history of the wire",
        _ANY,
        "The file lies in the user's own folder; its name keeps letters and digits only, and ends in a checksum.",
    )
    yield GatedKey(
        "run",
        "view, trigger, virtual table, computed column",
        "SQL, other file",
        _NOBODY,
        "The file is refused: a run consists of ordinary tables.",
    )
    yield GatedKey(
        "run",
        "-journal, -wal beside it",
        "other file, deleted or read by SQLite",
        _NOBODY,
        "The file is refused if what lies beside it names another file, or is a link or a pipe.",
    )


def _model_rows() -> Iterator[GatedKey]:
    yield GatedKey(
        "model",
        "rig",
        "rig file",
        _USER,
        "{where} names the rig file {text}, which is not read, because a model may come from anywhere. "
        "If you trust it, --rig {again} reads it.",
    )
    yield GatedKey(
        "model",
        "effects[].name, hysteresis.form",
        "plug-in, own Python file",
        _USER,
        "Only what is in use has a name here: smarig --plugin NAME COMMAND …, or --effect FILE.py.",
    )
    yield GatedKey(
        "model",
        "effects[].shape",
        "learned term",
        _ANY,
        "A learned term is a table of numbers, never a formula.",
    )
    yield GatedKey(
        "model",
        "provenance[].run",
        "earlier run",
        _NOBODY,
        "A run of this name and hash is looked for in the folders of the runs given and beside these. Otherwise the "
        "warning says which run to give too.",
    )


def _configuration_rows() -> Iterator[GatedKey]:
    by_a_file = "{where} names {text}, but came inside another file. " + _TRUST
    rig = by_a_file + "--rig RIG."
    for key, leads_to in (
        ("base", "other rig file"),
        ("actuator", "actuator file"),
        ("load.file", "CSV file"),
        ("load.formula", "formula: arithmetic of t"),
        ("links.DEVICE.driver", "own Python file, plug-in"),
        ("links.DEVICE.url", "serial port, network address"),
        ("links.DEVICE.settings", "VISA library, channels"),
        ("simulator.library", "native library"),
        ("simulator.faults", "TOML file"),
        ("simulator.trace", "CSV file, written; never one that exists"),
    ):
        yield GatedKey("rig", key, leads_to, _FILE, rig)
    yield GatedKey(
        "rig",
        "links.DEVICE.url with file=",
        "file, written by pySerial's spy://",
        _NOBODY,
        "Refused when the rig file is read.",
    )
    yield GatedKey(
        "actuator",
        "hysteresis.surface",
        "surface of Table 5.1",
        _ANY,
        "Another name is an error; it is no path.",
    )
    yield GatedKey(
        "actuator",
        "hysteresis.model.form",
        "plug-in, own Python file",
        _USER,
        "Only what is in use has a name here: smarig --plugin NAME COMMAND …. The rest is numbers.",
    )
    campaign = by_a_file + "smarig run CAMPAIGN."
    yield GatedKey("campaign", "step.protocol", "own Python file, plug-in", _FILE, campaign)
    yield GatedKey("campaign", "step.set.file", "CSV file", _FILE, campaign)
    yield GatedKey(
        "campaign",
        "step.name",
        "name of the run file, written",
        _FILE,
        "Refused unless it is a plain name: letters, digits, space, and - _ . + ( ).",
    )
    yield GatedKey(
        "mapping",
        "mat.files",
        "other files of the folder",
        _FILE,
        "Refused unless it is a file name with one *, without a folder.",
    )


def _data_rows() -> Iterator[GatedKey]:
    yield GatedKey(
        "folder of data or runs",
        "symbolic link",
        "any file",
        _USER,
        "A link in a folder that leads out of it is left out. Name its target to use it.",
    )
    yield GatedKey(
        "HDF5",
        "link, external or virtual storage",
        "any file, pipe, device",
        _NOBODY,
        "The data set is refused by name.",
    )
    yield GatedKey(
        "XLSX, ODS, Parquet, MAT",
        "link to another file, formula, macro",
        "other file, program",
        _NOBODY,
        "Not followed and not computed; stored values are read.",
    )
    yield GatedKey(
        "CSV", "cell", "formula", _NOBODY, "Text. In an exported table no cell begins as a formula."
    )


def _console_rows() -> Iterator[GatedKey]:
    click = "{where} names {text}, and came with its folder. " + _TRUST + "start it by a click."
    yield GatedKey("queue", "experiment", "protocol or campaign file", _USER, click)
    yield GatedKey("queue", "rig, load", "rig file, CSV file", _USER, click)
    yield GatedKey("queue", "out", "run file, written", _USER, click)
    yield GatedKey(
        "folder of a console",
        "rig file",
        "what a rig can name outside of the folder",
        _USER,
        "{where} names {text}, which lies outside of the folder and is opened only after a click on the rig's page.",
    )
    yield GatedKey(
        "folder of a console",
        "link where the console writes",
        "any folder, written: uploads, studies, pages, diagnoses, logs, library, queue",
        _NOBODY,
        "Refused: nothing is written through a link.",
    )


GATED_KEYS = {row.name: row for row in _rows()}
