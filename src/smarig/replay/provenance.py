"""Where a model comes from: what the runs say of their rig, wire and units, and which files they are.

Knows the description of a run. Refuses to know what was fitted.
"""

import hashlib
from collections.abc import Sequence
from typing import Any

from smarig.config import load_actuator
from smarig.core.errors import UsageError
from smarig.record import Run
from smarig.replay.model_file import ActuatorRecord, Provenance, SignalDescription


def provenance(run: Run) -> Provenance:
    """A run's identity: path, SHA-256 of the file, protocol, source, rows, sitting and encoder zero."""
    epoch, zero = run.meta.get("start_epoch"), run.meta.get("encoder_zero")
    return Provenance(
        run=str(run.path),
        sha256=file_hash(run),
        protocol=str(run.meta.get("protocol", "")),
        source=str(run.meta.get("source", "")),
        rows=len(run),
        start_epoch=float(epoch) if isinstance(epoch, int | float) else None,
        encoder_zero=str(zero) if zero is not None else None,
        wire=str(run.meta.get("wire") or ""),
    )


def file_hash(run: Run) -> str:
    """SHA-256 of the run's file, "" for a run that is only in memory."""
    if not run.path.is_file():
        return ""
    with run.path.open("rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()


def model_metadata(runs: Sequence[Run]) -> dict[str, Any]:
    """Fields of a Model that the first run tells: rig, actuator, arrangement, input and output."""
    meta = runs[0].meta
    name = str(meta.get("actuator", ""))
    parameters, arrangement = _actuator(name)
    return {
        "rig": str(meta.get("rig", "")),
        "actuator": ActuatorRecord(name=name, parameters=parameters),
        "arrangement": arrangement,
        "input": _channel(meta.get("input"), "input"),
        "output": _channel(meta.get("output"), "output"),
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


def _channel(entry: Any, fallback: str) -> SignalDescription:
    entry = entry if isinstance(entry, dict) else {}
    return SignalDescription(quantity=str(entry.get("quantity", fallback)), unit=str(entry.get("unit", "")))
