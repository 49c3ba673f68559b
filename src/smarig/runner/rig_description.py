"""Rig and actuator of a run, for its record: the texts of their files, every value, and the hashes of both.

The values include those that a file does not give, and those of its base. The code of an own driver is in the record
as an own file.
"""

import hashlib
import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from smarig.config import ActuatorFile, RigFile, driver_names, own_drivers
from smarig.core import file_bytes, is_file, offers_of_name, shipped_fault
from smarig.rig import DRIVERS

RIG_TEXT, ACTUATOR_TEXT = "config", "actuator_text"  # keys of the run table
RIG_VALUES, ACTUATOR_VALUES = "rig_values", "actuator_values"
HASHES = "rig_sha256"


def rig_description(
    rig_text: str, actuator_text: str, file: RigFile, actuator: ActuatorFile
) -> dict[str, Any]:
    """The keys of the run table that describe rig and actuator."""
    described = {
        RIG_TEXT: rig_text,
        ACTUATOR_TEXT: actuator_text,
        RIG_VALUES: rig_values(file),
        ACTUATOR_VALUES: actuator.model_dump(mode="json"),
    }
    return described | {HASHES: {key: sha256(value) for key, value in described.items()}}


def rig_values(file: RigFile) -> dict[str, Any]:
    """Every value of a rig file. Other files are named without their folder, so that they may move together."""
    values = file.model_dump(mode="json")
    values["actuator"] = Path(values["actuator"]).name
    for link in filter(None, (values["links"] or {}).values()):
        link["driver"] = Path(link["driver"]).name
    return values


def driver_codes(file: RigFile) -> dict[str, str]:
    """The code of the drivers from outside of smarig that a rig file names, as a text; nothing is executed.

    By the names of their files or plug-ins: the hash of a file, the distribution of a plug-in.
    """
    paths = [Path(driver) for driver in own_drivers(file)]
    offers = [offer for name in driver_names(file) for offer in offers_of_name(DRIVERS, name)]
    files = {
        p.name: code_text(hashlib.sha256(file_bytes(p)).hexdigest() if is_file(p) else "") for p in paths
    }
    return files | {offer.name: offer.origin for offer in offers if not shipped_fault(offer)}


def code_text(sha256_hash: str) -> str:
    """A hash as shown in comparisons; "" for a file that is not there.

    >>> code_text("0123456789abcdef0123"), code_text("")
    ('sha256 0123456789abcdef', 'sha256 unknown')
    """
    return f"sha256 {sha256_hash[:16] or 'unknown'}"


def sha256(value: str | Mapping[str, Any]) -> str:
    """The hash of a text, or of values as JSON with sorted keys."""
    text = value if isinstance(value, str) else json.dumps(value, sort_keys=True, separators=(",", ":"))
    return hashlib.sha256(text.encode("utf-8")).hexdigest()
