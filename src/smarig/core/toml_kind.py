"""Recognises the kind of a configuration file by its keys, so that a swapped file is named in one sentence."""

from collections.abc import Collection, Mapping
from typing import Any

RIG_FILE, ACTUATOR_FILE, CAMPAIGN_FILE = "a rig file", "an actuator file", "a campaign file"
MAPPING_FILE, PROJECT_SETTINGS = "a mapping file", "the settings of a Python project"
_KEYS = {
    RIG_FILE: {"actuator", "amplifier", "base", "encoder", "lease_s", "limits", "links", "period_s"},
    ACTUATOR_FILE: {"arrangement", "heating", "hysteresis", "thermomechanical", "transmission"},
    CAMPAIGN_FILE: {"step"},
    MAPPING_FILE: {"branch", "columns", "conditions", "ignore", "input", "output"},
    PROJECT_SETTINGS: {"build-system", "dependency-groups", "project", "tool"},
}
_TAKES = {
    RIG_FILE: "give it with `--rig`",
    ACTUATOR_FILE: 'name it in a rig file: actuator = "FILE.toml"',
    CAMPAIGN_FILE: "`smarig run` takes it",
    MAPPING_FILE: "give it to `smarig import` or `study` with `--map`",
    PROJECT_SETTINGS: "smarig does not read it",
}
_MOST_KEYS = 6  # listed in one sentence


def toml_kind(table: Mapping[str, Any]) -> str:
    """The kind of file that has most of these keys; "" if no kind or two kinds have them.

    >>> toml_kind({"name": "x", "step": []}), toml_kind({"name": "x"})
    ('a campaign file', '')
    """
    found = {kind: len(keys & table.keys()) for kind, keys in _KEYS.items()}
    best = max(found, key=lambda kind: found[kind])
    unique = list(found.values()).count(found[best]) == 1
    return best if found[best] and unique else ""


def swapped_table(table: Mapping[str, Any], wanted: str, where: str, required: Collection[str]) -> str:
    """A sentence on a file that is of another kind than ``wanted``, or has few of its ``required`` keys; "" else."""
    kind = toml_kind(table)
    if kind and kind != wanted:
        return f"{where} is {kind}, not {wanted}: {_TAKES[kind]}."
    missing = [key for key in required if key not in table]
    if 2 * len(missing) < len(required) or kind == wanted:
        return ""
    shown = ", ".join(missing[:_MOST_KEYS]) + (", …" if len(missing) > _MOST_KEYS else "")
    return f"{where} is not {wanted}: {len(missing)} of {len(required)} required keys are missing ({shown})."
