"""The wiping-out test of §5.3.1: does a peak erase the memory of smaller extrema before it?"""

from smarig.core import Mark, Protocol, Settled
from smarig.protocols._building_blocks import checked_count, evenly_spaced, saturate, settle_at
from smarig.protocols._setup import Setup

# Shares of the range at which the nested branches of one segment reverse (Fig. 5.5).
_TURNS = (0.9, 0.2, 0.72, 0.35, 0.58)


def wiping_out(setup: Setup, *, points_per_branch: int = 5, settle: Settled | None = None) -> Protocol:
    """Two identical nested inputs A and B with four nested branches each; B must retrace A (Fig. 5.5).

    The peak that starts B wipes out the memory of A if the wire has a Preisach representation (§3.3.1).
    """
    checked_count("points_per_branch", points_per_branch, 1, 1000)
    settle = settle or Settled()
    turns = [setup.at(share) for share in _TURNS]
    yield Mark("wiping-out", {"turns_K": turns})
    yield from saturate(setup, settle)
    start = setup.lower_K
    for segment in ("A", "B"):
        yield from settle_at(
            setup, evenly_spaced(start, turns[0], points_per_branch), f"{segment} peak", settle
        )
        for k in range(1, len(turns)):
            branch = evenly_spaced(turns[k - 1], turns[k], points_per_branch)
            yield from settle_at(setup, branch, f"{segment} {k}", settle)
        start = turns[-1]
    yield from saturate(setup, settle)
