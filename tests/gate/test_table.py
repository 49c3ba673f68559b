"""The table of the gate: shown as it is, complete for the schemas of files, and obeyed by the one function."""

import pickle
import re
from copy import deepcopy

import pytest
from pydantic import AfterValidator

from generate import gate, keys
from generate.files import models
from smarig.config import RigFile, file_tables, load_rig
from smarig.core import GATED_KEYS, Named, Origin, UsageError, check_table, named, passed
from smarig.record import RunInfo

ROW = "run: begun_with.rig"


def test_the_page_shows_the_table_of_the_code():
    page = gate.PAGE.read_text(encoding="utf-8")
    assert gate.with_block(page) == page, "run python -m generate.gate in docs/"
    assert all(f"`{row.key}`" in page for row in GATED_KEYS.values())


def test_every_refusal_names_the_file_and_the_path_or_says_what_happens_instead():
    for row in GATED_KEYS.values():
        if row.least in (Origin.FILE, Origin.USER) and "{" in row.sentence:
            sentence = row.sentence.format(where="a.file", text="b.path", again="b.path")
            assert "a.file" in sentence, row.name
            assert "b.path" in sentence, row.name
        assert row.sentence.endswith("."), row.name


@pytest.mark.parametrize("origin", Origin)
@pytest.mark.parametrize("key", GATED_KEYS)
def test_a_text_passes_from_the_least_trusted_origin_that_may_name_it(key, origin):
    text, least = named("a.path", key, "a.file", origin), GATED_KEYS[key].least
    if least is not None and origin >= least:
        assert type(passed(text)) is str
    else:
        with pytest.raises(UsageError):
            passed(text)
    assert passed(text, ["a.path"]) == "a.path", "what smarig brings may be named by anybody"


def test_a_mark_stays_with_a_text_and_with_the_less_trusted():
    text = named("a.toml", ROW, "a.run.sqlite")
    copies = [str(text), deepcopy(text), pickle.loads(pickle.dumps(text)), named(text, ROW, "b", Origin.USER)]
    assert all(isinstance(copy, Named) and copy.origin is Origin.INSIDE for copy in copies)
    assert [copy.where for copy in copies] == ["a.run.sqlite"] * 4
    assert passed("typed by the user") == "typed by the user"
    with pytest.raises(KeyError):
        named("a.toml", "run: no such key", "a.run.sqlite")


def test_a_configuration_carries_who_named_what_it_names():
    inside = load_rig("one_wire_serial").model_dump(exclude_none=True)
    inside["simulator"]["library"] = "evil.so"
    file = check_table(RigFile, inside, "a.run.sqlite", Origin.INSIDE)
    assert file.simulator is not None
    assert file.links is not None
    for text in (
        file.simulator.library,
        file.links.amplifier.driver,
        file.actuator,
        file.model_copy().actuator,
    ):
        assert isinstance(text, Named)
        assert (text.origin, text.where) == (Origin.INSIDE, "a.run.sqlite")
    mine = check_table(RigFile, inside, "mine.toml")
    assert mine.simulator is not None
    assert passed(mine.simulator.library) == "evil.so"


def test_a_record_marks_what_it_names():
    launch = {"rig": "r.toml", "load": "l.csv", "effects": ["e.py=1"], "rig_wire": "w"}
    info = RunInfo.of({"rig": "r", "actuator": "a", "protocol": "p", "begun_with": launch}, "x.run.sqlite")
    assert info.launch_args is not None
    marked = [info.rig, info.actuator, info.protocol, info.launch_args["rig"], info.launch_args["load"]]
    for text in (*marked, info.launch_args["effects"][0]):
        assert isinstance(text, Named), text
        assert text.where == "x.run.sqlite"
        with pytest.raises(UsageError):
            passed(text)


# Texts of configuration and model files that lead nowhere. Each was looked at; a new key of text must be judged too.
INERT = (
    *("name", "kind", "wire", "source", "notes", "summary", "unit", "material", "arrangement", "initial"),
    *(
        "heat_loss",
        "twin_heat",
        "framing",
        "serial_format",
        "devices",
        "make",
        "purpose",
        "quantity",
        "text",
        "column",
        "columns",
        "matrix",
    ),
    *(
        "channel",
        "blames",
        "names",
        "fraction",
        "fraction_unit",
        "delimiter",
        "decimal",
        "thousands",
        "header_starts",
        "no_reading",
        "sheet",
        "group",
    ),
    *("written", "repeated", "zero", "direction", "own_units", "steps", "loops", "ignore", "conditions"),
    *("format", "created", "sha256", "protocol", "encoder_zero", "value", "parameters", "warnings"),
    *("covariance", "intervals", "fit", "extension", "measurement", "self_sensing"),
)
_CATALOGUE = "model: effects[].name, hysteresis.form"
ROWS = {
    "base": "rig: base",
    "surface": "actuator: hysteresis.surface",
    "model": "actuator: hysteresis.model.form",
    "files": "mapping: mat.files",
    "set": "campaign: step.set.file",
    "settings": "rig: links.DEVICE.settings",
    "run": "model: provenance[].run",
    "effects": _CATALOGUE,
    "hysteresis": _CATALOGUE,
}


def test_every_key_of_text_is_marked_or_in_the_table_or_known_to_lead_nowhere():
    tables = [inner for model, _ in keys.FILES.values() for _, inner in file_tables(model)]
    tables += [inner for _, inner in models()]
    of_text = [
        (table, name, field)
        for table in tables
        for name, field in table.model_fields.items()
        if re.search(r"\bstr\b|\bAny\b", str(field.annotation))
    ]
    judged = {name for _, name, _ in of_text}
    unknown = {f"{t.__name__}.{n}" for t, n, f in of_text if n not in (*INERT, *ROWS) and not _is_marked(f)}
    assert not unknown, "say in the table of the gate where it leads, or here that it leads nowhere"
    assert set(ROWS.values()) <= GATED_KEYS.keys()
    assert {"driver", "url", "library", "faults", "trace", "actuator", "rig"} <= judged - {*INERT, *ROWS}


def _is_marked(field):
    """Whether a text of the key is marked when its file is read."""
    marks = (m.func for m in field.metadata if isinstance(m, AfterValidator))
    return any(mark.__qualname__.startswith("marked_as.") for mark in marks)
