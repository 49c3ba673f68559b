"""Compares the rig and the actuator of a run with those of today, value by value, before the run is resumed.

A run has one scale, one heating model and one tick. A value that reaches its numbers must therefore be the same; the
others may differ, and each difference is told and recorded.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import PurePath
from typing import Any

from smarig.config import ActuatorFile, RigFile, rig_from_text
from smarig.core import DataError, Origin, Source, TomlTable, UsageError, is_path
from smarig.record import Run
from smarig.runner.own_files import own_file_entries
from smarig.runner.resume.damaged_record import damaged_record_as_data_error
from smarig.runner.resume.reach import SOURCE, Reach, reach_of
from smarig.runner.rig_description import (
    ACTUATOR_TEXT,
    ACTUATOR_VALUES,
    HASHES,
    RIG_TEXT,
    RIG_VALUES,
    code_text,
    driver_codes,
    rig_values,
    sha256,
)
from smarig.runner.session import Session

_FILES = {RIG_VALUES: ("rig file", RIG_TEXT), ACTUATOR_VALUES: ("actuator file", ACTUATOR_TEXT)}
_MOST_SHOWN = 3
_SOURCE = Source("A record", Origin.INSIDE)  # of what it names, which is compared and never opened


@dataclass(frozen=True)
class RigChange:
    """A value that differs: its key, the recorded and the present value as texts, and how far it reaches.

    A text that differs without its values has a sentence of its own; its values are hashes.
    """

    key: str
    was: str
    now: str
    reach: Reach
    words: str = ""

    def sentence(self) -> str:
        """The difference in words.

        >>> RigChange("transmission.radius", "15 mm", "18 mm", Reach.NUMBERS).sentence()
        'transmission.radius was 15 mm, is now 18 mm'
        """
        return self.words or f"{self.key} was {self.was}, is now {self.now}"


@dataclass(frozen=True)
class RigComparison:
    """The differences that do not prevent resuming. ``not_compared`` names what the record does not hold, or ""."""

    changes: tuple[RigChange, ...] = ()
    not_compared: str = ""

    @property
    def remarks(self) -> tuple[str, ...]:
        """One sentence for all differences, and one for what could not be compared."""
        changed = "; ".join(change.sentence() for change in self.changes)
        changed = f"Since the interruption, {changed}" if changed else ""
        return tuple(f"{text}." for text in (changed, self.not_compared) if text)


def check_same_rig(run: Run, session: Session) -> RigComparison:
    """Compare the rig of a run with that of a session. Raises UsageError if a value that reaches numbers differs."""
    _check_hashes(run)
    check_names(run, session.file, session.actuator.file)
    with damaged_record_as_data_error(run):
        found, not_compared = _all_changes(run, session)
    twin = run.info.source != "bench"
    refused = [c for c in found if c.reach is Reach.NUMBERS or (twin and c.reach is Reach.TWIN)]
    refused = refused or _scale_change(run, session)
    if refused:
        shown = "; ".join(c.sentence() for c in refused[:_MOST_SHOWN])
        more = f"; and {len(refused) - _MOST_SHOWN} more" if len(refused) > _MOST_SHOWN else ""
        raise UsageError(
            f"{run.path.name} was made with other values of its rig: {shown}{more}. Its numbers would no "
            "longer agree. Restore what was changed (the record holds the files), or start a new run."
        )
    return RigComparison(tuple(found), not_compared)


def check_names(run: Run, file: RigFile, actuator: ActuatorFile) -> None:
    """Raise UsageError if a run was made on a rig or an actuator of another name, or at another period."""
    for what, then, now in (
        ("rig", run.info.rig, file.name),
        ("actuator", run.info.actuator, actuator.name),
        ("period_s", run.info.period_s, file.period_s),
    ):
        if then != now:
            raise UsageError(
                f"{run.path.name} was run on {what} '{then}', not on '{now}'. It cannot continue there."
            )


def _check_hashes(run: Run) -> None:
    """Raise DataError if what the record holds of the rig is not what was recorded."""
    for key in (RIG_TEXT, ACTUATOR_TEXT, RIG_VALUES, ACTUATOR_VALUES) if HASHES in run.meta else ():
        value = run.meta.get(key)
        if not isinstance(value, str | dict) or sha256(value) != run.info.rig_sha256.get(key):
            raise DataError(f"{run.path.name}: its {key} differs from its hash. The record is damaged.")


def _recorded(run: Run) -> tuple[dict[str, Any], str]:
    """What a run holds of its rig, and what it does not hold. Earlier versions recorded the text of the rig alone."""
    if HASHES in run.meta:
        tables = {RIG_VALUES: _completed(RigFile, run.info.rig_values)}
        tables[ACTUATOR_VALUES] = _completed(ActuatorFile, run.info.actuator_values)
        return run.meta | tables, ""
    file = rig_from_text(run.info.config or "")
    if file is None:
        return {}, "The record holds no values of its rig and actuator, so only its scale was compared"
    return {RIG_VALUES: rig_values(file)}, (
        "The record holds no values of its actuator, so only its scale was compared"
    )


def _all_changes(run: Run, session: Session) -> tuple[list[RigChange], str]:
    """The differences of both files and of own drivers, and what could not be compared."""
    recorded, not_compared = _recorded(run)
    present = dict(session.description)
    codes = {
        name if origin else PurePath(path).name: origin or code_text(sha256_hash)
        for kind, name, path, sha256_hash, origin in own_file_entries(run)
        if kind == "driver"
    }
    for side, used in ((recorded, codes), (present, driver_codes(session.file))):
        side |= {RIG_VALUES: _with_code(side[RIG_VALUES], used)} if RIG_VALUES in side else {}
    return [c for table in _FILES for c in _file_changes(table, recorded, present)], not_compared


def _completed(schema: type[TomlTable], values: Mapping[str, Any]) -> Mapping[str, Any]:
    """Recorded values with the defaults of keys that files have only since then; others stay as they are."""
    try:
        return schema.model_validate(values, context=_SOURCE).model_dump(mode="json")
    except ValueError:
        return values


def _with_code(values: Mapping[str, Any], codes: Mapping[str, str]) -> dict[str, Any]:
    """Values of a rig in which an own driver is named with the hash of its code, a plug-in with its distribution."""
    links = {
        device: {**link, "driver": f"{link['driver']} ({codes.get(link['driver'], code_text(''))})"}
        if link and (is_path(link["driver"]) or link["driver"] in codes)
        else link
        for device, link in (values.get("links") or {}).items()
    }
    return {**values, "links": links or None}


def _scale_change(run: Run, session: Session) -> list[RigChange]:
    """A different scale: the only trace of an edited actuator in the records of earlier versions."""
    then = run.info.output.per_count
    now = session.actuator.resolution(session.file.encoder)
    if then is None or then == now:
        return []
    unit = run.info.output.unit
    return [RigChange("one count of the encoder", f"{then:g} {unit}", f"{now:g} {unit}", Reach.NUMBERS)]


def _file_changes(table: str, recorded: Mapping[str, Any], present: Mapping[str, Any]) -> list[RigChange]:
    """The differences of one file; that of its text, if its values are all the same."""
    if table not in recorded:
        return []
    was, now = dict(_values(recorded[table])), dict(_values(present[table]))
    found = [
        RigChange(key, was.get(key, "not given"), now.get(key, "not given"), reach_of(table, key))
        for key in sorted({*was, *now})
        if was.get(key) != now.get(key)
    ]
    words, text = _FILES[table]
    if found or text not in recorded or recorded[text] == present[text]:
        return found
    was_hash, now_hash = sha256(recorded[text]), sha256(present[text])
    return [
        RigChange(
            text, was_hash, now_hash, Reach.NOTHING, f"the {words} has another text, but the same values"
        )
    ]


def _values(table: Mapping[str, Any], place: str = "") -> Iterator[tuple[str, str]]:
    """(key, value as text) of a table and of those in it; a quantity is its value with its unit, and its source."""
    for name, value in table.items():
        key = f"{place}{name}"
        if not isinstance(value, dict):
            yield key, _text(value)
        elif value.keys() == {"value", "unit", "source"}:
            yield key, f"{_text(value['value'])} {value['unit']}"
            yield key + SOURCE, _text(value["source"])
        else:
            yield from _values(value, f"{key}.")


def _text(value: Any) -> str:
    """A value as text: different texts for different values.

    >>> _text(15.0), _text(0.1 + 0.2), _text(None), _text("a")
    ('15', '0.30000000000000004', 'not given', "'a'")
    """
    if value is None:
        return "not given"
    if isinstance(value, float):
        return f"{value:g}" if float(f"{value:g}") == value else repr(value)
    return repr(value)
