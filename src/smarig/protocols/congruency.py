"""The congruency test of §5.3.2: do minor loops between the same inputs have the same shape?"""

from smarig.core import Mark, Protocol, Settled, UsageError
from smarig.protocols._building_blocks import checked_count, evenly_spaced, saturate, settle_at
from smarig.protocols._setup import Setup


def congruency(
    setup: Setup,
    *,
    low: float = 0.3,
    high: float = 0.5,
    peak: float = 0.9,
    points_per_branch: int = 6,
    settle: Settled | None = None,
) -> Protocol:
    """Two minor loops between the same inputs, with a higher peak between them (Fig. 5.9).

    ``low``, ``high`` and ``peak`` are shares of the range. Loop A starts at its top on the rising major branch, loop B
    at its bottom after the peak. The inputs are the same and the histories differ. If the wire has a Preisach
    representation, both loops have the same shape (§3.3.2).
    """
    if not 0 <= low < high < peak <= 1:
        raise UsageError(f"congruency needs 0 ≤ low < high < peak ≤ 1, got {low:g}, {high:g}, {peak:g}.")
    settle = settle or Settled()
    bottom, top, crest = setup.at(low), setup.at(high), setup.at(peak)
    n = checked_count("points_per_branch", points_per_branch, 1, 1000)
    yield Mark("congruency", {"bottom_K": bottom, "top_K": top, "peak_K": crest})
    yield from saturate(setup, settle)
    yield from settle_at(setup, evenly_spaced(setup.lower_K, top, n), "rise", settle)
    yield from settle_at(setup, evenly_spaced(top, bottom, n), "A down", settle)
    yield from settle_at(setup, evenly_spaced(bottom, top, n), "A up", settle)
    yield from settle_at(setup, evenly_spaced(top, crest, n), "peak", settle)
    yield from settle_at(setup, evenly_spaced(crest, bottom, n), "fall", settle)
    yield from settle_at(setup, evenly_spaced(bottom, top, n), "B up", settle)
    yield from settle_at(setup, evenly_spaced(top, bottom, n), "B down", settle)
    yield from saturate(setup, settle)
