"""The crossing of the default one-wire twin, which the measured wire of the thesis does not have (§5.4.1)."""

from collections.abc import Sequence
from typing import Any

from smarig.preisach import thesis_surface
from smarig.record import Run
from smarig.theory import crossing_descending

_THESIS_WIRE = "one"  # surfaces of the one-wire rig, whose measured curves do not cross


def twin_crossing_note(runs: Sequence[Run]) -> str:
    """A sentence on crossing curves of a twin whose surface itself crosses; "" for all other runs.

    The thesis finds no crossing in the measured curves of this wire; its fitted surface one_e has one.
    """
    names = {_surface_name(run) for run in runs}
    if len(names) != 1 or not (name := names.pop()).startswith(f"{_THESIS_WIRE}_"):
        return ""
    surface = thesis_surface(name)
    found = crossing_descending(surface)
    if found is None:
        return ""
    return (
        f"This crossing is that of the twin's surface {name} of Table 5.1 (up to {found.depth:.2g} {surface.unit}); "
        "the curves that the thesis measured on its wire do not cross (§5.4.1)."
    )


def _surface_name(run: Run) -> str:
    """The surface of Table 5.1 that a twin simulates; "" for a bench, another surface, or a thermomechanical wire."""
    values: Any = run.info.actuator_values
    if not run.twin or not isinstance(values, dict) or values.get("thermomechanical"):
        return ""
    section = values.get("hysteresis")
    name = section.get("surface") if isinstance(section, dict) else None
    return name if isinstance(name, str) else ""
