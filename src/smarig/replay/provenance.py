"""Where a model comes from: what the runs say of their rig, wire and units, and which files they are.

Knows the description of a run. Refuses to know what was fitted.
"""

import hashlib
from collections.abc import Sequence
from typing import Any

from smarig.config import load_actuator
from smarig.core.errors import UsageError
from smarig.record import Run, SignalInfo
from smarig.replay.model_file import ActuatorRecord, Provenance, SignalDescription


def provenance(run: Run) -> Provenance:
    """A run's identity: path, SHA-256 of the file, protocol, source, rows, sitting and encoder zero."""
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
    )


def file_hash(run: Run) -> str:
    """SHA-256 of the run's file, "" for a run that is only in memory."""
    if not run.path.is_file():
        return ""
    with run.path.open("rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()


def model_metadata(runs: Sequence[Run]) -> dict[str, Any]:
    """Fields of a Model that the first run tells: rig, actuator, arrangement, input and output."""
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
    """Parameter set of a known actuator; nothing is made up for an unknown one."""
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
