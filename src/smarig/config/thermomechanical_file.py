"""The table [thermomechanical] of an actuator file: the alloy in Brinson's model, its resistivity, the load."""

from typing import Annotated, Literal

from pydantic import AfterValidator, model_validator

from smarig.config.quantity import NotNegativeIn, PositiveIn, Quantity, WithinIn
from smarig.core import TomlTable

Celsius = Annotated[Quantity, AfterValidator(WithinIn("degC", -273.15, 1000.0))]
Megapascals = Annotated[Quantity, AfterValidator(PositiveIn("MPa", 1.0, 1e6))]
Slope = Annotated[Quantity, AfterValidator(PositiveIn("MPa/K", 0.1, 1000.0))]
Share = Annotated[Quantity, AfterValidator(PositiveIn("1", 1e-5, 0.2))]
PerKelvin = Annotated[Quantity, AfterValidator(NotNegativeIn("1/K", 0.0, 0.01))]
Resistivity = Annotated[Quantity, AfterValidator(PositiveIn("ohm m", 1e-9, 1e-3))]
Newtons = Annotated[Quantity, AfterValidator(PositiveIn("N", 1e-6, 1e6))]
Torque = Annotated[Quantity, AfterValidator(WithinIn("N mm", -1e6, 1e6))]
LatentHeat = Annotated[Quantity, AfterValidator(NotNegativeIn("J/kg", 0.0, 1e6))]

LARGEST_STRESS_MPA = 1000.0  # the phase diagram is checked up to here; NiTi yields below


class ThermomechanicalSection(TomlTable):
    """Makes the twin's wire a thermomechanical one (Brinson's model and a heat balance) in place of [hysteresis],
    which then only supplies the travel and the phases that readings are checked against.
    """

    modulus_austenite: Megapascals  # Young's modulus of austenite
    modulus_martensite: Megapascals  # Young's modulus of martensite
    residual_strain: Share  # largest strain of detwinning
    martensite_finish: Celsius  # M_f without stress
    martensite_start: Celsius  # M_s without stress
    austenite_start: Celsius  # A_s without stress
    austenite_finish: Celsius  # A_f without stress
    slope_martensite: Slope  # C_M: stress that raises the forward transformation by one kelvin
    slope_austenite: Slope  # C_A: stress that raises the reverse transformation by one kelvin
    critical_stress_start: Megapascals  # at and below M_s: detwinned martensite begins to form
    critical_stress_finish: Megapascals  # at and below M_s: all martensite is detwinned
    expansion_austenite: PerKelvin  # thermal expansion of austenite
    expansion_martensite: PerKelvin  # thermal expansion of martensite
    latent_heat: LatentHeat  # heat that the forward transformation releases
    resistivity_austenite: Resistivity  # at the reference temperature
    resistivity_martensite: Resistivity  # at the reference temperature
    resistivity_slope_austenite: PerKelvin  # relative change per kelvin
    resistivity_slope_martensite: PerKelvin  # relative change per kelvin
    reference_temperature: Celsius  # of thermal expansion and resistivities
    heat_loss: Literal["free_convection", "constant"]  # Churchill and Chu (1975), or the h of [heating]
    force: Newtons | None = None  # one wire: the weight
    pre_strain: Share | None = None  # two wires: strain of each after assembly
    shaft_torque: Torque | None = None  # two wires: constant load on the shaft; wire 1 lifts a positive one

    @property
    def width_K(self) -> float:
        """The least width of a transformation: A_f − A_s, M_s − M_f, or (σ_f^cr − σ_s^cr)/C_M at constant stress."""
        critical_MPa = self.critical_stress_finish.value - self.critical_stress_start.value
        return min(
            self.austenite_finish.value - self.austenite_start.value,
            self.martensite_start.value - self.martensite_finish.value,
            critical_MPa / self.slope_martensite.value,
        )

    @model_validator(mode="after")
    def _ordered(self) -> "ThermomechanicalSection":
        for low, high in (
            ("martensite_finish", "martensite_start"),
            ("austenite_start", "austenite_finish"),
            ("critical_stress_start", "critical_stress_finish"),
        ):
            if not getattr(self, low).value < getattr(self, high).value:
                raise ValueError(f"{low} must be smaller than {high}")
        return self

    @model_validator(mode="after")
    def _strips_apart(self) -> "ThermomechanicalSection":
        """Brinson's kinetics give a wire one direction at a time, so both strips must not overlap."""
        for stress_MPa in (0.0, self.critical_stress_start.value, LARGEST_STRESS_MPA):
            reverse = self.austenite_start.value + stress_MPa / self.slope_austenite.value
            above_start = max(stress_MPa - self.critical_stress_start.value, 0.0)
            forward = self.martensite_start.value + above_start / self.slope_martensite.value
            if reverse <= forward:
                raise ValueError(
                    f"at {stress_MPa:g} MPa austenite forms from {reverse:.1f} degC on, where martensite forms below "
                    f"{forward:.1f} degC; raise austenite_start, or make both slopes alike"
                )
        return self
