"""Building blocks of protocols: settled holds at inputs, and checks of settings."""

from collections.abc import Iterable, Sequence

from smarig.core import Hold, Protocol, Settled, UsageError
from smarig.preisach import THESIS_PARTITIONS
from smarig.protocols._setup import Setup


def settle_at(setup: Setup, inputs_K: Iterable[float], branch: str, settle: Settled) -> Protocol:
    """Hold each input until the wire has settled (§5.2.1, steps 4 and 5)."""
    for input_K in inputs_K:
        yield Hold(setup.current_for(input_K), settle, target=input_K, branch=branch)


def saturate(setup: Setup, settle: Settled, *, upper: bool = False) -> Protocol:
    """Go to saturation at one end of the range, which wipes out all memory (negative unless ``upper``)."""
    yield from settle_at(setup, [setup.upper_K if upper else setup.lower_K], "saturate", settle)


def checked_inputs(setup: Setup, inputs_K: Sequence[float], name: str) -> tuple[float, ...]:
    """The inputs, checked against the rig's range. UsageError names the first input outside it."""
    for value in inputs_K:
        if not setup.lower_K - 1e-6 <= value <= setup.upper_K + 1e-6:
            raise UsageError(
                f"{name}: {value:g} K is outside the rig's range {setup.lower_K:g}…{setup.upper_K:g} K above ambient."
            )
    return tuple(float(v) for v in inputs_K)


def default_partition(setup: Setup) -> tuple[float, ...]:
    """The thesis's partition (§5.4.1), scaled to the range that the rig's limits allow."""
    levels = THESIS_PARTITIONS["two_wire" if setup.two_wire else "one_wire"]
    up = setup.upper_K / levels[-1]
    down = setup.lower_K / levels[0] if levels[0] else 1.0
    return tuple(level * (up if level > 0 else down) for level in levels)


def checked_partition(
    setup: Setup, partition_K: Sequence[float], name: str = "partition_K"
) -> tuple[float, ...]:
    """A checked partition: at least three strictly increasing inputs inside the range."""
    levels = checked_inputs(setup, partition_K, name)
    if len(levels) < 3:
        raise UsageError(f"{name} needs at least 3 inputs, got {len(levels)}.")
    for before, after in zip(levels, levels[1:], strict=False):
        if not after > before:
            raise UsageError(f"{name} must increase: {after:g} follows {before:g}.")
    return levels


def checked_count(name: str, value: int, least: int, most: int) -> int:
    """A number of points, loops and so on, checked. UsageError if it is outside least…most."""
    if not least <= value <= most:
        raise UsageError(f"{name} must lie between {least} and {most}, got {value}.")
    return value


def evenly_spaced(start: float, stop: float, points: int) -> list[float]:
    """``points`` evenly spaced inputs from start (excluded) to stop (included)."""
    between = [start + (stop - start) * (k + 1) / points for k in range(points - 1)]
    return [*between, stop]  # exactly: rounding beyond the range would be refused
