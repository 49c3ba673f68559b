"""The sentences about curves of heat flow: why there is no model, the temperatures of each cycle, and the direction."""

from collections.abc import Iterator

from smarig.core import spaced
from smarig.report import display_unit, number, to_uncertainty
from smarig.transformation import HEAT_TEMPERATURES, Calorimetry, CalorimetryCycle

_NO_MODEL = "This is a DSC curve: heat flow is a rate, not the output of a hysteresis, so no Preisach model is fitted."
_HEATS = {"heating_heat": "on heating", "cooling_heat": "on cooling"}


def heat_flow_sentences(found: Calorimetry) -> list[str]:
    """Why there is no model, then the temperatures of each cycle, and which direction is exothermic."""
    cycles = [_cycle_sentence(found, cycle) for cycle in found.cycles]
    missing = [*missing_sentences(found), *narrow_sentences(found)]
    directed = any(cycle.figures for cycle in found.cycles) or not found.agrees
    return [_NO_MODEL, *cycles, *missing, *([direction_sentence(found)] if directed else [])]


def _cycle_sentence(found: Calorimetry, cycle: CalorimetryCycle) -> str:
    values = [f"{n} {value_text(found, cycle, n)}" for n in HEAT_TEMPERATURES if n in cycle.figures]
    heats = [f"{value_text(found, cycle, n)} {w}" for n, w in _HEATS.items() if n in cycle.figures]
    latent = f"; latent heat {', '.join(heats)}" if heats else ""
    which = f"Cycle {cycle.number}: " if len(found.cycles) > 1 else ""
    if not values:
        return f"{which}No transformation temperatures."
    return f"{which}{', '.join(values)}{latent}."


def value_text(found: Calorimetry, cycle: CalorimetryCycle, name: str) -> str:
    """A figure with unit and interval: "55.8 °C (55.2 to 56.3)"."""
    drawn = cycle.figures[name]
    low, high = drawn.ci95
    half = (high - low) / 2
    ends = f"{to_uncertainty(low, half)} to {to_uncertainty(high, half)}"
    return f"{to_uncertainty(drawn.value, half)}{spaced(display_unit(found.unit_of(name)))} ({ends})"


def direction_sentence(found: Calorimetry) -> str:
    """Which direction is exothermic, how that is known, and whether the peaks agree."""
    if found.stated and found.agrees:
        return f"Exothermic is {found.exothermic}, as the file says."
    if found.stated:
        return (
            f"The file says that exothermic is {found.exothermic}, but a peak points the other way: heating to "
            "austenite takes up heat, cooling gives it off. Check the direction."
        )
    if found.agrees:
        return (
            f"Exothermic is {found.exothermic}: no word of the file says it, but heating to austenite takes up heat "
            "and cooling gives it off."
        )
    return (
        "The file does not say which direction is exothermic, and the peaks of heating and cooling contradict each "
        f"other; {found.exothermic} was taken."
    )


def missing_sentences(found: Calorimetry) -> Iterator[str]:
    """Why figures are missing, each reason once for a cycle."""
    for cycle in found.cycles:
        names: dict[str, list[str]] = {}
        for name, reason in cycle.why_not.items():
            names.setdefault(reason, []).append(_HEATS.get(name, name).replace("on ", "latent heat of "))
        for reason, own in names.items():
            which = f"Cycle {cycle.number}: no" if len(found.cycles) > 1 else "No"
            yield f"{which} {', '.join(own)}: {reason}."


def narrow_sentences(found: Calorimetry) -> Iterator[str]:
    """That the peaks of a cycle overlap, which those of a martensite hardly do and those of an R-phase do."""
    for cycle in found.cycles:
        if not all(name in cycle.figures for name in HEAT_TEMPERATURES):
            continue
        start, top, end, first, low, last = (cycle.figures[name].value for name in HEAT_TEMPERATURES)
        if abs(top - low) < min(end - start, first - last):
            apart = f"{number(abs(top - low), 2)}{spaced(display_unit('K'))}"
            which = f"Cycle {cycle.number}: the" if len(found.cycles) > 1 else "The"
            yield (
                f"{which} peaks of heating and cooling overlap (A_p and M_p lie {apart} apart), as those of an R-phase "
                "do: M_s and M_f may be its R_s and R_f."
            )


def rate_text(cycle: CalorimetryCycle) -> str:
    """The rates of the branches of a cycle, "" if no time is recorded."""
    rates = [f"{s.direction} at {number(s.rate_K_per_min)} K/min" for s in cycle.scans if s.rate_K_per_min]
    return f"Cycle {cycle.number}: {', '.join(rates)}." if rates else ""
