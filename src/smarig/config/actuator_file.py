"""The schema of actuator files: frozen values. Each error is one sentence that names its key.

Physical quantities have no defaults. The comment after each key is its text in the reference.
"""

import math
from typing import Any, Literal

from pydantic import SerializerFunctionWrapHandler, model_serializer, model_validator

from smarig.config.quantity import Amperes, Density, Kelvin, Millimetres, Ohms, PulleyRadius, SpecificHeat
from smarig.config.thermomechanical_file import LARGEST_STRESS_MPA, ThermomechanicalSection
from smarig.core import ACTUATOR_FILE, TomlTable

TAU_RANGE_S = (1e-3, 1e5)  # of a wire in air: from micrometres to a bar


class WireSection(TomlTable):
    """The wire. Lengths are those of one active wire."""

    material: str  # alloy and manufacturer
    diameter: Millimetres  # diameter of the wire
    active_length: Millimetres  # length of one wire between the clamps
    density: Density  # density of the alloy
    specific_heat: SpecificHeat  # specific heat of the alloy


TwinHeat = Literal["mean_resistance", "phase_resistance"]


class HeatingSection(TomlTable):
    """Determines the temperature: resistances and one known steady state (5.3)."""

    resistance_martensite: Ohms  # resistance of the cold wire
    resistance_austenite: Ohms  # resistance of the hot wire
    reference_current: Amperes  # current of the known steady state
    reference_temperature: Kelvin  # temperature above ambient at that current; gives R/hA (5.3)
    twin_heat: TwinHeat = "mean_resistance"  # a twin's heat: i² times the mean resistance (5.1), or V·i


class TransmissionSection(TomlTable):
    """Converts contraction into encoder angle and into the rig's unit of position."""

    unit: Literal["mm", "deg"]  # unit of position, here and in every file made with this wire
    radius: PulleyRadius  # radius of the pulley that the wire turns


SurfaceName = Literal["one_c", "one_p", "one_e", "two_c", "two_p", "two_e"]


class HysteresisSection(TomlTable):
    """The operator of a twin, with which a bench compares its readings: ``surface`` or ``model`` is given."""

    surface: SurfaceName | None = None  # name of a surface of Table 5.1: of one wire, or of two
    model: dict[str, Any] | None = None  # hysteresis of a model, written by smarig calibrate --model
    initial: Literal["negative", "anhysteretic"]  # initial state of a twin's wire

    @model_validator(mode="after")
    def _one_operator(self) -> "HysteresisSection":
        if (self.surface is None) == (self.model is None):
            raise ValueError("exactly one of surface and model is needed")
        return self

    @model_serializer(mode="wrap")
    def _what_is_given(self, dump: SerializerFunctionWrapHandler) -> dict[str, Any]:
        """Records hold the key that is given, as those of earlier versions do."""
        return {key: value for key, value in dump(self).items() if value is not None}


class ActuatorFile(TomlTable):
    """configs/actuators/NAME.toml"""

    file_kind = ACTUATOR_FILE
    name: str  # name of the file
    arrangement: Literal["one_wire", "two_wire"]  # two wires work against each other
    source: str  # source of the set of values
    wire: WireSection  # the wire
    heating: HeatingSection  # determines the temperature
    transmission: TransmissionSection  # converts contraction into position
    hysteresis: HysteresisSection  # the hysteresis of a twin
    thermomechanical: ThermomechanicalSection | None = None  # a twin's wire that is no Preisach operator
    notes: str = ""  # a remark

    @model_validator(mode="after")
    def _time_constant_of_a_wire(self) -> "ActuatorFile":
        """Values that are possible alone may make no wire together: τ = ρ c_p V T_ref/(R I_ref²) shows it."""
        wire, heat = self.wire, self.heating
        volume_m3 = math.pi / 4 * wire.diameter.value**2 * wire.active_length.value * 1e-9
        mean_ohm = (heat.resistance_martensite.value + heat.resistance_austenite.value) / 2
        power_W = mean_ohm * heat.reference_current.value**2
        capacity_J_per_K = wire.density.value * wire.specific_heat.value * volume_m3
        tau_s = capacity_J_per_K * heat.reference_temperature.value / power_W
        if not TAU_RANGE_S[0] <= tau_s <= TAU_RANGE_S[1]:
            raise ValueError(
                f"the values of [wire] and [heating] give a thermal time constant of {tau_s:.3g} s, which must lie "
                f"between {TAU_RANGE_S[0]:g} and {TAU_RANGE_S[1]:g} s; check diameter, active_length and "
                "reference_current"
            )
        return self

    @model_validator(mode="after")
    def _load_fits_arrangement(self) -> "ActuatorFile":
        t, two = self.thermomechanical, self.arrangement == "two_wire"
        if t is None:
            return self
        needed, other = ("pre_strain", "force") if two else ("force", "pre_strain")
        if getattr(t, needed) is None or getattr(t, other) is not None:
            raise ValueError(
                f"{'two wires' if two else 'one wire'} need thermomechanical.{needed} and no thermomechanical.{other}"
            )
        if self.transmission.unit != ("deg" if two else "mm"):
            raise ValueError(
                "a thermomechanical wire has its position in mm, a pair of them in deg; set transmission.unit"
            )
        if t.shaft_torque is not None:
            if not two:
                raise ValueError(
                    "one wire has no thermomechanical.shaft_torque; its load is thermomechanical.force"
                )
            self._check_stress("shaft_torque", abs(t.shaft_torque.value) / self.transmission.radius.value)
        if t.force is not None:
            self._check_stress("force", t.force.value)
        for phase in ("martensite", "austenite"):
            self._check_resistivity(t, phase)
        return self

    def _check_stress(self, load: str, force_N: float) -> None:
        """Raise ValueError for a load that would break a wire."""
        stress_MPa = force_N / self._section_mm2
        if stress_MPa > LARGEST_STRESS_MPA:
            raise ValueError(
                f"thermomechanical.{load} stresses a wire by {stress_MPa:.4g} MPa; at most {LARGEST_STRESS_MPA:g} MPa "
                "are allowed"
            )

    def _check_resistivity(self, t: ThermomechanicalSection, phase: str) -> None:
        """Raise ValueError if resistivity and resistance are those of different wires."""
        length_mm = self.wire.active_length.value
        ohm = 1e3 * getattr(t, f"resistivity_{phase}").value * length_mm / self._section_mm2
        stated_ohm = getattr(self.heating, f"resistance_{phase}").value
        if not 0.5 < ohm / stated_ohm < 2.0:
            raise ValueError(
                f"thermomechanical.resistivity_{phase} and the size of the wire give {ohm:.4g} ohm, but "
                f"heating.resistance_{phase} is {stated_ohm:g} ohm"
            )

    @property
    def _section_mm2(self) -> float:
        return math.pi / 4 * self.wire.diameter.value**2
