"""The provenance of a model: what the runs record of rig, wire and units, and the identity of their files."""

import hashlib
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from smarig.config import load_actuator
from smarig.core import UsageError
from smarig.record import CONTINUED, AnyRun, Run, SignalInfo, load_run
from smarig.replay.conditions import recorded_conditions
from smarig.replay.model_file import ActuatorRecord, Model, Provenance, SignalDescription


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


def file_hash(run: AnyRun) -> str:
    """SHA-256 of the run's file, "" for a run that is only in memory."""
    if not run.path.is_file():
        return ""
    with run.path.open("rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()


def model_metadata(runs: Sequence[Run]) -> dict[str, Any]:
    """Fields of a Model that the first run records: rig, actuator, arrangement, input and output."""
    info = runs[0].info
    name = info.text_of("actuator", "")
    parameters, arrangement = _actuator(name)
    return {
        "rig": info.text_of("rig", ""),
        "actuator": ActuatorRecord(name=name, parameters=parameters),
        "arrangement": arrangement,
        "input": _channel(info.input, "input"),
        "output": _channel(info.output, "output"),
    }


def _actuator(name: str) -> tuple[dict[str, Any], str]:
    """Parameter set of a known actuator; empty for an unknown one."""
    if not name:
        return {}, ""
    try:
        file = load_actuator(name)
    except UsageError:
        return {}, ""
    sections = ("wire", "heating", "transmission")
    return {key: getattr(file, key).model_dump(mode="json") for key in sections}, file.arrangement


def _channel(signal: SignalInfo, fallback: str) -> SignalDescription:
    return SignalDescription(quantity=signal.text_of("quantity", fallback), unit=signal.unit)


def earlier_runs(model: Model, runs: Sequence[Run]) -> list[Run]:
    """Other runs of the same session that the model was made from, if their files still exist unchanged."""
    found = [(p, load_run(p.run)) for p in _same_session_provenance(model, runs) if Path(p.run).is_file()]
    return [run for p, run in found if file_hash(run) == p.sha256]


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
