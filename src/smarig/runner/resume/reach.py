"""How far each value of a rig file and of an actuator file reaches: whether a run may be resumed after it was changed.

A key that is not listed counts as one that reaches the numbers.
"""

from enum import Enum, auto

from smarig.config import LinksFile, ThermomechanicalSection
from smarig.runner.rig_description import ACTUATOR_VALUES, RIG_VALUES

MODEL = "hysteresis.model"  # and the keys of its table


class Reach(Enum):
    """How far a value reaches."""

    NUMBERS = auto()  # the recorded numbers: a difference is refused
    TWIN = auto()  # the numbers of a twin; on hardware only previews and checks: refused on a twin
    SAFETY = auto()  # what the rig permits: told as a warning
    NOTHING = auto()  # how a device is reached, and words: told


_LINK = {
    "driver": Reach.NUMBERS,  # an own driver with the hash of its code
    "framing": Reach.NOTHING,
    "url": Reach.NOTHING,  # the device itself is recognised by its identity
    "baud": Reach.NOTHING,
    "serial_format": Reach.NOTHING,
    "address": Reach.NOTHING,
    "timeout_s": Reach.NOTHING,
    "line_end": Reach.NOTHING,
    "settings": Reach.NUMBERS,  # channels and scales
}
_THERMOMECHANICAL = tuple(f"thermomechanical.{key}" for key in ThermomechanicalSection.model_fields)
REACH: dict[str, dict[str, Reach]] = {
    RIG_VALUES: {
        "name": Reach.NUMBERS,
        "kind": Reach.NUMBERS,
        "base": Reach.NOTHING,  # its values are compared
        "actuator": Reach.NOTHING,  # its values are compared
        "wire": Reach.NOTHING,  # the wire of the session is compared, which may have been given
        "period_s": Reach.NUMBERS,
        "ambient_degC": Reach.TWIN,
        "lease_s": Reach.SAFETY,
        "temperature_noise_K": Reach.TWIN,
        "temperature_noise_time_s": Reach.TWIN,
        "hidden_effect": Reach.TWIN,
        "load.force_N": Reach.TWIN,
        "load.formula": Reach.TWIN,
        "load.file": Reach.TWIN,
        # A limit also scales many protocols. Their commands are compared with the record when they are replayed.
        "limits.current_min_A": Reach.SAFETY,
        "limits.current_max_A": Reach.SAFETY,
        "limits.current_rate_A_per_s": Reach.SAFETY,
        "limits.temperature_max_K": Reach.SAFETY,
        "limits.resistance_tolerance": Reach.SAFETY,
        "limits.model_tolerance": Reach.SAFETY,
        "limits.voltage_max_V": Reach.SAFETY,
        "limits.stress_max_MPa": Reach.SAFETY,
        "limits.cycles_max": Reach.SAFETY,
        "amplifier.saturation_A": Reach.TWIN,
        "amplifier.current_noise_A": Reach.TWIN,
        "amplifier.voltage_noise_V": Reach.TWIN,
        "encoder.counts_per_rev": Reach.NUMBERS,
        "encoder.resolution": Reach.NUMBERS,
        "encoder.noise_counts": Reach.TWIN,
        **{
            f"links.{device}.{key}": reach
            for device in LinksFile.model_fields
            for key, reach in _LINK.items()
        },
        "protection.slew_max_A_per_s": Reach.SAFETY,
        "protection.resistance_min_ohm": Reach.SAFETY,
        "protection.resistance_max_ohm": Reach.SAFETY,
        "protection.heat_max_A2s": Reach.SAFETY,
        "protection.heat_settle_s": Reach.SAFETY,
        "simulator.devices": Reach.NUMBERS,
        "simulator.make": Reach.NUMBERS,
        "simulator.start": Reach.NUMBERS,  # other devices, with a wire of their own
        "simulator.speed": Reach.NOTHING,
        "simulator.faults": Reach.NUMBERS,
        "simulator.library": Reach.NUMBERS,
        "simulator.trace": Reach.NOTHING,
    },
    ACTUATOR_VALUES: {
        "name": Reach.NUMBERS,
        "arrangement": Reach.NUMBERS,
        "source": Reach.NOTHING,
        "notes": Reach.NOTHING,
        "wire.material": Reach.NOTHING,
        "wire.diameter": Reach.NUMBERS,
        "wire.active_length": Reach.NUMBERS,
        "wire.density": Reach.NUMBERS,
        "wire.specific_heat": Reach.NUMBERS,
        "heating.resistance_martensite": Reach.NUMBERS,
        "heating.resistance_austenite": Reach.NUMBERS,
        "heating.reference_current": Reach.NUMBERS,
        "heating.reference_temperature": Reach.NUMBERS,
        "heating.twin_heat": Reach.TWIN,
        "transmission.unit": Reach.NUMBERS,
        "transmission.radius": Reach.NUMBERS,
        "hysteresis.surface": Reach.TWIN,
        MODEL: Reach.TWIN,
        "hysteresis.initial": Reach.TWIN,
        **dict.fromkeys(_THERMOMECHANICAL, Reach.TWIN),
    },
}
SOURCE = ".source"  # of a quantity: words


def reach_of(table: str, key: str) -> Reach:
    """How far a value of the rig or of the actuator reaches."""
    if key.startswith(MODEL):
        key = MODEL
    return Reach.NOTHING if key.endswith(SOURCE) else REACH[table].get(key, Reach.NUMBERS)
