"""The provenance of a model: what the runs record of rig, wire and units, and the identity of their files."""

import hashlib
from collections.abc import Iterator, Sequence
from pathlib import Path, PureWindowsPath
from typing import Any

from smarig.core import UsageError, leads_out
from smarig.record import ABSOLUTE_ZERO, CONTINUED, AnyRun, Run, SignalInfo, load_run
from smarig.replay.conditions import recorded_conditions
from smarig.replay.model_file import ActuatorRecord, Model, Provenance, SignalDescription
from smarig.replay.recorded_actuator import recorded_actuator


def provenance(run: Run) -> Provenance:
    """A run's identity: path, SHA-256 of the file, protocol, source, rows, session and encoder zero."""
    epoch, zero = run.info.start_epoch, run.info.encoder_zero
    return Provenance(
        run=str(run.path),
        sha256=file_hash(run),
        protocol=run.info.text_of("protocol", ""),
        source=run.info.text_of("source", ""),
        rows=len(run),
        start_epoch=None if epoch is None else float(epoch),
        encoder_zero=zero,
        wire=run.info.wire or "",
        conditions=recorded_conditions(run),
    )


def share_zero(one: Provenance, other: Provenance) -> bool:
    """Whether two runs count from the same zero: that of one session, or of one absolute sensor."""
    same_session = one.start_epoch is not None and one.start_epoch == other.start_epoch
    same_sensor = (one.encoder_zero or "").startswith(ABSOLUTE_ZERO)
    return (same_session or same_sensor) and one.encoder_zero == other.encoder_zero


def file_hash(run: AnyRun) -> str:
    """SHA-256 of the run's file, "" for a run that is only in memory."""
    return _sha256(run.path)


def _sha256(path: Path) -> str:
    if not path.is_file():
        return ""
    with path.open("rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()


def model_metadata(runs: Sequence[Run]) -> dict[str, Any]:
    """Fields of a Model that the first run records: rig, actuator, arrangement, input and output."""
    info = runs[0].info
    name = info.text_of("actuator", "")
    parameters, arrangement = _actuator(runs[0])
    return {
        "rig": info.text_of("rig", ""),
        "actuator": ActuatorRecord(name=name, parameters=parameters),
        "arrangement": arrangement,
        "input": _channel(info.input, "input"),
        "output": _channel(info.output, "output"),
    }


def _actuator(run: Run) -> tuple[dict[str, Any], str]:
    """Parameter set of a known actuator; empty for an unknown one."""
    try:
        actuator = recorded_actuator(run)
    except UsageError:
        actuator = None
    if actuator is None:
        return {}, ""
    sections = ("wire", "heating", "transmission")
    file = actuator.file
    return {key: getattr(file, key).model_dump(mode="json") for key in sections}, file.arrangement


def _channel(signal: SignalInfo, fallback: str) -> SignalDescription:
    return SignalDescription(quantity=signal.text_of("quantity", fallback), unit=signal.unit)


def earlier_runs(model: Model, runs: Sequence[Run]) -> list[Run]:
    """Other runs of the same session that the model was made from, if they lie unchanged beside the given runs.

    A model may come from anywhere, so the paths in it are not followed: a run is looked for by its name in the folders
    of the given runs, and by that of its folder beside these (``train`` beside ``held_out``).
    """
    earlier = [(p, file) for p in _same_session_provenance(model, runs) for file in _places(p.run, runs)]
    return list({p.sha256: load_run(file) for p, file in earlier if _sha256(file) == p.sha256}.values())


def _places(recorded: str, runs: Sequence[Run]) -> Iterator[Path]:
    """Where a run may lie, whatever its recorded path; no link leads out of there."""
    path = PureWindowsPath(recorded)  # understands both kinds of separators
    for folder in dict.fromkeys(run.path.parent for run in runs if run.path.is_file()):
        places = (folder, folder / path.name), (folder.parent, folder.parent / path.parent.name / path.name)
        yield from (file for top, file in places if file.is_file() and not leads_out(file, top))


def missing_earlier_runs(model: Model, runs: Sequence[Run]) -> list[str]:
    """Earlier runs of the sessions of ``runs`` that are neither given nor found.

    Nothing is missing where the history begins as it did when the model was fitted.
    """
    known = [*runs, *earlier_runs(model, runs)]
    missing = [p.run for p in _same_session_provenance(model, known)]
    first = min(known, key=lambda run: float(run["t_s"][0]) if run.has("t_s") else 0.0)
    fitted = {p.sha256 for p in model.provenance}
    if not missing and first.info.initial == CONTINUED and file_hash(first) not in fitted:
        missing = [f"the run before {first.path.name}"]
    return missing


def _same_session_provenance(model: Model, runs: Sequence[Run]) -> list[Provenance]:
    """The provenance of the model within the sessions of runs, without those runs."""
    sessions = {(p.start_epoch, p.encoder_zero) for p in map(provenance, runs)}
    given_hashes = {file_hash(run) for run in runs}
    return [
        p
        for p in model.provenance
        if p.start_epoch is not None
        and (p.start_epoch, p.encoder_zero) in sessions
        and p.sha256 not in given_hashes
    ]
