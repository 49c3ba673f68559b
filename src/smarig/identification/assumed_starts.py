"""Runs whose starting state was assumed, and how much that matters: the error of a model from either saturation."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from smarig.core import spaced
from smarig.measurement import Start, StartingState, may_assume_start, reversals, starting_state
from smarig.record import FORC_PROTOCOL, Run, continues_run
from smarig.replay import Model, simulate_runs

MATTERS = 1.1  # times the error from the assumed state: an error from the other one above this is stated
MOST_NAMES = 5  # runs that a sentence lists
_OTHER: dict[Start, Start] = {"negative": "positive", "positive": "negative"}


@dataclass(frozen=True)
class AssumedStart:
    """The assumed ``state`` of a run, and the rms error of a model from it and from the other saturation."""

    run: str
    state: Start
    rms: float
    other_rms: float


def assumed_starts(model: Model, runs: Sequence[Run]) -> list[AssumedStart]:
    """The runs whose starting state a model assumes, with errors at the points whose memory then counts as known. The
    zero of each run is free.
    """
    found = []
    for k, run in enumerate(runs):
        start = _assumed(model, run)
        if start is None or start.state is None or (k and continues_run(runs[k - 1], run)):
            continue
        states = (start.state, _OTHER[start.state])
        rms, other = (_rms(model, run.with_meta(initial=state), start.first) for state in states)
        found.append(AssumedStart(run.name, start.state, rms, other))
    return found


def assumed_starts_text(found: Sequence[AssumedStart], unit: str) -> list[str]:
    """What was assumed, how much it matters, and what to do; nothing if it hardly matters."""
    relevant = [f for f in found if not f.other_rms <= MATTERS * f.rms]
    if not relevant:
        return []
    names = ", ".join(f.run for f in relevant[:MOST_NAMES])
    more = f" and {len(relevant) - MOST_NAMES} more" if len(relevant) > MOST_NAMES else ""
    states = {f.state for f in relevant}
    saturation = (
        f"{states.pop()} saturation" if len(states) == 1 else "the saturation next to its first input"
    )
    rms, other = (np.sqrt(np.mean(np.square([(f.rms, f.other_rms) for f in relevant]), axis=0))).tolist()
    return [
        f"The state at the start of {names}{more} is not recorded; {saturation} was assumed. The model's rms error is "
        f"{rms:.3g}{spaced(unit)} from there and {other:.3g}{spaced(unit)} from the other saturation. "
        "If you know the state, write "
        'initial = "negative" or "positive" in the mapping and import again.'
    ]


def _assumed(model: Model, run: Run) -> StartingState | None:
    """The state that is assumed for a run on its own, None if none is."""
    (u, y), h = run.points(), model.hysteresis
    if run.info.protocol == FORC_PROTOCOL or not u.size or not may_assume_start(run):
        return None
    start = starting_state(
        run.info.initial,
        u,
        (h.lower, h.upper),
        first_input=float(run["input"][0]),
        turns=reversals(u),
        outputs=y,
    )
    return start if start.assumed else None


def _rms(model: Model, run: Run, first: int) -> float:
    """The rms error at the points of a run from one of them on, about its mean."""
    error = (simulate_runs(model, [run])[0] - run.points()[1])[first:]
    return float(np.nanstd(error))
