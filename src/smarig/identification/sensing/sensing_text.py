"""What self-sensing has found, in words: the map of each wire, and where the resistance tells no position."""

from smarig.control import AMBIGUOUS_SHARE, ResistanceMap, SelfSensing

_UNITS = {
    "1": "ohm",
    "y": "ohm/{}",
    "T": "ohm/K",
    "yT": "ohm/({} K)",
    "xi": "ohm",
    "xiy": "ohm/{}",
    "m": "ohm/{}",
}


def sensing_text(sensing: SelfSensing, unit: str) -> list[str]:
    """A line for each wire and one for the observer."""
    lines = [_map_text(k, wire, sensing, unit) for k, wire in enumerate(sensing.wires, start=1)]
    return [
        *lines,
        f"The noise of a reading is {1e3 * sensing.noise_V:.2g} mV. A reading needs at least {sensing.least_A:.2g} A. "
        f"It is ambiguous where its 99.7 % interval is wider than ±{100 * AMBIGUOUS_SHARE:.0f} % of the stroke. "
        f"Intervals are widened by {sensing.interval_factor:.2f}, those of single readings by "
        f"{sensing.reading_factor:.2f}.",
    ]


def _map_text(number: int, wire: ResistanceMap, sensing: SelfSensing, unit: str) -> str:
    values = ", ".join(
        f"{name}: {value:.5g} {_UNITS[name].format(unit)} ({_ends(wire, name)})"
        for name, value in wire.coefficients.items()
    )
    which = f"Wire {number}: " if len(sensing.wires) > 1 else ""
    return (
        f"{which}R by its terms (95 %): {values}; error of the map {1e3 * wire.error_ohm:.2g} mohm, n = {wire.n}. "
        f"{_sign_text(wire, len(sensing.wires) > 1)}"
    )


def _ends(wire: ResistanceMap, name: str) -> str:
    low, high = wire.intervals.get(name, (float("nan"), float("nan")))
    return f"{low:.5g} to {high:.5g}"


def _sign_text(wire: ResistanceMap, two_wire: bool) -> str:
    """Whether resistance changes with position itself, by the sign of its slope at zero temperature and phase."""
    low, high = wire.intervals.get("y", (float("nan"), float("nan")))
    if low > 0 or high < 0:
        return f"The resistance of the cold wire {'rises' if low > 0 else 'falls'} with the position."
    if two_wire:
        return (
            "The resistance does not depend on the position itself, only on the phase of this wire: it shows the "
            "position only while this wire transforms."
        )
    return "The resistance of the cold wire does not depend on the position."
