"""The effects that act on the heat of a wire or on its thermometer, with the values that are tried first.

| effect | acts on | parameters of ``HeatBalance`` |
|---|---|---|
| ``convection`` | loss | exponent |
| ``settling`` | loss | share and time constant of a second mass |
| ``ambient_drift`` | loss | drift of the room in kelvin per time |
| ``latent_heat`` | heat | latent heat over heat capacity, of heating and of cooling |
| ``sensor_lag`` | thermometer | first-order lag and dead time |
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np

from smarig.diagnosis.comparison.thermal.thermal_record import ThermalRecord

Tries = Mapping[str, tuple[float, ...]]


@dataclass(frozen=True)
class ThermalEffect:
    """An effect: the variable that its errors go with, and by parameter the values that are tried on a record, between
    whose ends the search goes on.
    """

    name: str
    acts_through: str
    tries: Callable[[ThermalRecord], Tries]


def _times(x: ThermalRecord) -> tuple[float, ...]:
    return tuple(np.geomspace(0.25 * x.dt, 0.2 * x.length, 8).tolist())


def _drifts(x: ThermalRecord) -> tuple[float, ...]:
    sizes = np.geomspace(0.01, 1.0, 5) * x.span / x.length
    return (*(-sizes[::-1]).tolist(), *sizes.tolist())


LATENT_K = (0.0, 1.0, 3.0, 10.0, 30.0, 100.0)  # NiTi: 12 to 37 J/g over 0.47 to 0.84 J/(g K)
EFFECTS = (
    ThermalEffect(
        "convection", "temperature", lambda _: {"exponent": (-0.3, -0.1, 0.05, 0.1, 0.2, 0.4, 0.8)}
    ),
    ThermalEffect(
        "sensor_lag", "heating_rate", lambda x: {"dead": (0.0, *_times(x)), "lag": (0.0, *_times(x))}
    ),
    ThermalEffect(
        "settling",
        "time",
        lambda x: {
            "mass_tau": tuple(s * x.length for s in (0.1, 0.02, 0.05, 0.2, 0.5, 1.5)),
            "mass_share": (0.03, 0.1, 0.3, 0.6, 0.9),
        },
    ),
    ThermalEffect("ambient_drift", "time", lambda x: {"drift": _drifts(x)}),
    ThermalEffect("latent_heat", "temperature", lambda _: {"latent_K": LATENT_K, "cooling_K": LATENT_K}),
)


def testable_effects(x: ThermalRecord) -> list[ThermalEffect]:
    """The effects that a record could show: latent heat needs a measured transformation, and a measured room is a part
    of the plain model.
    """
    return [
        e
        for e in EFFECTS
        if not (e.name == "latent_heat" and x.share is None)
        and not (e.name == "ambient_drift" and x.room_known)
    ]


def parameter_unit(name: str, unit: str) -> str:
    """The unit of a parameter of the balance, given that of the time."""
    units = {"gain": f"K/({unit} drive)", "drift": f"K/{unit}", "exponent": "1", "mass_share": "1"}
    return units.get(name, unit if name in ("tau", "lag", "dead", "mass_tau") else "K")
