"""Types of keys that lead out of a configuration file: their texts are marked for the gate when the file is read."""

from typing import Annotated, Any

from pydantic import AfterValidator

from smarig.core import marked_as, refuse_control_characters, refuse_null_characters

ActuatorName = Annotated[str, marked_as("rig: actuator")]
LoadFormula = Annotated[str, marked_as("rig: load.formula")]
LoadPath = Annotated[str, marked_as("rig: load.file")]
DriverName = Annotated[str, marked_as("rig: links.DEVICE.driver")]
LinkUrl = Annotated[str, marked_as("rig: links.DEVICE.url")]
FaultsPath = Annotated[str, marked_as("rig: simulator.faults")]
LibraryPath = Annotated[str, marked_as("rig: simulator.library")]
TracePath = Annotated[str, marked_as("rig: simulator.trace")]
ProtocolName = Annotated[str, marked_as("campaign: step.protocol")]

# They lead out too, by way of a driver, a protocol or a command: each checks what they name.
MakeName = Annotated[str, AfterValidator(refuse_control_characters)]
Settings = Annotated[dict[str, Any], AfterValidator(refuse_null_characters)]
