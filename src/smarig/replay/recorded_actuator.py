"""The actuator of a run: as the record holds it, so that no file has to be read that a record names."""

from contextlib import suppress
from pathlib import Path, PureWindowsPath

from pydantic import ValidationError

from smarig.config import ActuatorFile, shipped_names
from smarig.core import ConfigError, Origin, Source, UsageError, leads_out, load_toml
from smarig.plant import Actuator
from smarig.record import AnyRun


def recorded_actuator(run: AnyRun) -> Actuator | None:
    """The actuator with the values that it had in the run; else of the file of this name; None if it has none.

    That file is one of smarig, or lies beside the run or in the folder above. It holds numbers only. Raises UsageError
    if there is none, without its contents if it is none.
    """
    if run.info.actuator_values:
        source = Source(run.path.name, Origin.INSIDE)
        with suppress(ValidationError):  # of another version
            return Actuator(ActuatorFile.model_validate(run.info.actuator_values, context=source))
    name = run.info.actuator
    if not name:
        return None
    file = None if name in shipped_names("actuators") else _file_nearby(run.path, name)
    if file is None:
        return Actuator.named(name)
    try:
        return Actuator(load_toml(ActuatorFile, file))
    except (ConfigError, UsageError):
        raise UsageError(f"{run.path.name} names the file {file}, which is no actuator file.") from None


def _file_nearby(run: Path, name: str) -> Path | None:
    """A file of this name, whatever its recorded folder, beside a run or in the folder above."""
    plain = PureWindowsPath(str.__str__(name)).name  # understands both kinds of separators
    folders = (run.parent, run.parent.parent)
    found = ((folder / plain, folder) for folder in folders if plain.endswith(".toml"))
    return next((file for file, folder in found if file.is_file() and not leads_out(file, folder)), None)
