"""An identified material in words: parameters in the units that people read, reasons, errors."""

from collections.abc import Iterator, Mapping, Sequence
from typing import TYPE_CHECKING

from smarig.core import spaced
from smarig.identification.interval_estimate import Estimate
from smarig.identification.material.parameters import PARAMETERS

if TYPE_CHECKING:
    from smarig.identification.material.material_identification import MaterialIdentification

_SHOWN = {"1": (1.0, ""), "degC": (1.0, "°C"), "1/K": (1e6, "10⁻⁶/K"), "MPa": (1.0, "MPa")}
_WORDS = {
    "modulus_austenite": "Young's modulus of austenite",
    "modulus_martensite": "Young's modulus of martensite",
    "strain_least": "transformation strain at no stress",
    "strain_saturated": "transformation strain at large stress",
    "strain_rate": "rate at which it saturates",
    "strain_stress": "stress up to which it is least",
    "austenite_start": "austenite start, at no stress",
    "austenite_finish": "austenite finish, at no stress",
    "martensite_start": "martensite start, at no stress",
    "martensite_finish": "martensite finish, at no stress",
    "slope_austenite": "dσ/dT of heating",
    "slope_martensite": "dσ/dT of cooling",
    "exponent_cooling_start": "hardening exponent, start of cooling",
    "exponent_cooling_finish": "hardening exponent, finish of cooling",
    "exponent_heating_finish": "hardening exponent, finish of heating",
    "exponent_heating_start": "hardening exponent, start of heating",
    "expansion_austenite": "thermal expansion of austenite",
    "expansion_martensite": "thermal expansion of martensite",
    "wide_share": "share that transforms over a wider range",
    "wide_factor": "how many times as wide",
}


def quantity_name(name: str) -> tuple[str, str]:
    """The symbol of a parameter and its meaning."""
    return PARAMETERS[name].symbol, _WORDS[name]


def value_text(name: str, value: float) -> str:
    """A value of a parameter as it is read."""
    shown, _, unit = parameter_cells(name, Estimate(value, (value, value), PARAMETERS[name].unit, "", 0))
    return f"{shown:.4g}{spaced(unit)}".replace("-", "−")


def parameter_cells(name: str, e: Estimate) -> tuple[float, tuple[float, float], str]:
    """Value, interval and unit as they are read: strains in %, moduli in GPa, expansions in 10⁻⁶/K."""
    scale, unit = _SHOWN.get(e.unit, (1.0, e.unit))
    if name.startswith("strain_") and e.unit == "1":
        scale, unit = 100.0, "%"
    if name.startswith("modulus_"):
        scale, unit = 1e-3, "GPa"
    return scale * e.value, (scale * e.ci95[0], scale * e.ci95[1]), unit


def estimate_text(name: str, e: Estimate) -> str:
    """A parameter with its interval."""
    value, (low, high), unit = parameter_cells(name, e)
    return f"{value:.4g}{spaced(unit)} (95 %: {low:.4g} to {high:.4g})"


def reasons_text(reasons: Mapping[str, str]) -> Iterator[str]:
    """A sentence for each reason, with the parameters that it is true of."""
    for why in dict.fromkeys(reasons.values()):
        symbols = [PARAMETERS[n].symbol for n, reason in reasons.items() if reason == why]
        verb = "is" if len(symbols) == 1 else "are"
        yield f"{_listed(symbols)} {verb} not determined: {why}."


def _listed(words: Sequence[str]) -> str:
    return " and ".join(filter(None, [", ".join(words[:-1]), words[-1]]))


def material_text(found: "MaterialIdentification") -> str:
    """The result as lines of text."""
    names = [n for n in PARAMETERS if n in found.parameters]
    lines = [f"{PARAMETERS[n].symbol:5} = {estimate_text(n, found.parameters[n])}" for n in names]
    what = "ε_L + σ ΔS" if found.strain_is_sum else "ε_L"
    lines += [f"{what} at {stress:.4g} MPa = {estimate_text('strain_', e)}" for stress, e in found.strains]
    lines.append(f"C_A and C_M are the slopes at {found.law.reference_stress:.4g} MPa.")
    lines += reasons_text(found.not_determined)
    heat = found.latent_heat
    lines.append(
        f"Latent heat = {heat}"
        if isinstance(heat, Estimate)
        else f"The latent heat is not determined: {heat}"
    )
    for r in found.records:
        out = r.left_out_rms
        predicted = "" if out is None else f", {100 * out:.3f} % if predicted from the other loads"
        lines.append(f"{r.record.name}, {r.record.condition}: error {100 * r.rms:.3f} %{predicted}")
    lines.append(f"Error of all {found.n} readings: {100 * found.rms:.3f} % of strain (rms)")
    if found.twin is not None:
        lines.append(found.twin if isinstance(found.twin, str) else found.twin.sentence)
    return "\n".join(lines)
