"""What a run was started with, as its record states it; refuses runs that cannot be resumed."""

from collections.abc import Callable, Mapping
from typing import Any

from smarig.core import DataError, UsageError
from smarig.record import Run
from smarig.runner.own_files import check_own_files, with_files_given

_LAUNCH_TYPES: dict[str, Callable[[Any], bool]] = {
    "rig": lambda value: isinstance(value, str),
    "rig_wire": lambda value: isinstance(value, str),
    "speed": lambda value: value is None or (isinstance(value, int | float) and not isinstance(value, bool)),
    "effects": lambda value: isinstance(value, list) and all(isinstance(pair, str) for pair in value),
    "noise": lambda value: isinstance(value, bool),
    "settings": lambda value: isinstance(value, dict),
}


def read_launch_args(run: Run, given: Mapping[str, Any] | None = None) -> Mapping[str, Any]:
    """The arguments with which a run was started. Raises UsageError or DataError if it cannot be resumed.

    ``given``: the settings that name files, given again.
    """
    name = run.path.name
    if run.cause == "done":
        raise UsageError(f"{name} is finished; there is nothing to resume.")
    if run.info.closed_loop:
        raise UsageError(
            f"{name} is a closed loop and cannot be resumed. Prepare the wire and start the loop again."
        )
    launch = run.info.launch_args
    wanted = {"rig", "rig_wire", "speed", "effects", "noise", "settings"}
    if run.info.source == "simulation" or launch is None or not wanted <= set(launch):
        raise DataError(
            f"{name} does not state what it was started with. Only runs that this smarig recorded on a rig or a "
            "twin can be resumed."
        )
    if launch["effects"] is None:
        raise DataError(f"{name} was run with effects that are not in its record, so it cannot be resumed.")
    check_own_files(run)
    if not all(fits(launch[key]) for key, fits in _LAUNCH_TYPES.items()):
        raise DataError(f"{name} cannot be resumed: its record is damaged (what it was started with).")
    return {**launch, "settings": with_files_given(run, launch["settings"], given or {})}
