"""The identity of a run: the same for its copies, under any name, while it is recorded and after it was resumed.

It is made of what the file has held since the first sample and never changes. A run whose start is not recorded (an
import, a simulation) is written at once, so the hashes of its samples identify it.
"""

import hashlib
import json
from typing import Any

from smarig.record import StoredRun

_CONSTANT_KEYS = (
    *("start_epoch", "source", "protocol", "settings", "seed", "effects"),
    *("rig", "wire", "actuator", "period_s", "model", "along"),
)
_LENGTH = 20  # hexadecimal digits: 80 bits


def run_identity(run: StoredRun) -> str:
    """The identity of a run."""
    facts: list[Any] = [run.meta.get(key) for key in _CONSTANT_KEYS]
    facts.append(run.first_sample)
    if run.info.start_epoch is None:
        hashes = run.meta.get("hashes")
        facts += [
            run.info.imported and run.info.imported.sha256,
            hashes.get("sample") if isinstance(hashes, dict) else None,
        ]
    return content_identity(json.dumps(facts, sort_keys=True, default=str).encode())


def content_identity(content: bytes) -> str:
    """The identity of a content."""
    return hashlib.sha256(content).hexdigest()[:_LENGTH]
