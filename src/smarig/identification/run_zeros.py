"""The zeros of outputs that are fitted together: common to all runs, or one for each run whose file has its own.

The offset between the zero of a model and that of a run, where the record determines it.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from smarig.core import spaced
from smarig.identification.measured.zero_by_load import stress_at_start, zero_slope_of
from smarig.identification.positive.observations import COMMON, Observations
from smarig.record import FORC_PROTOCOL, OWN_ZERO, Run
from smarig.replay import (
    Model,
    driven_by_input,
    provenance,
    recorded_start,
    share_zero,
    simulate_runs,
    stress_at_points,
)

DISAGREE = 0.8  # of the rms error: what is left of it about the means of the runs if their zeros may disagree


def has_own_zero(run: Run) -> bool:
    """Whether the zero of a run's output is unrelated to that of other runs."""
    return run.info.encoder_zero == OWN_ZERO


def with_own_zeros(observations: Observations, runs: Sequence[Run]) -> Observations:
    """Observations of runs with a free zero for each run that has its own.

    The first run keeps the common zero if all have their own: it determines the zero of the model.
    """
    own = [has_own_zero(run) for run in runs]
    if all(own):
        own[0] = False
    zeros = np.where(own, np.cumsum(own) - 1, COMMON)
    return replace(observations, zero=np.repeat(zeros, observations.known))


def spread_about_zeros(observations: Observations) -> float:
    """Standard deviation of the outputs about the mean of those with one zero."""
    parts = [observations.y[observations.zero == zero] for zero in np.unique(observations.zero)]
    return float(np.std(np.concatenate([y - y.mean() for y in parts])))


def zeros_disagree(model: Model, runs: Sequence[Run]) -> bool:
    """Whether the errors of a model of several imported runs with a common zero mostly lie in the runs' means."""
    if len(runs) < 2 or any(
        r.info.source != "import" or r.info.protocol == FORC_PROTOCOL or has_own_zero(r) for r in runs
    ):
        return False
    pairs = zip(simulate_runs(model, runs), runs)
    errors = [(e := y - run.points()[1])[np.isfinite(e)] for y, run in pairs]
    errors = [e for e in errors if e.size]
    about_means = np.concatenate([e - e.mean() for e in errors])
    return bool(np.std(about_means) < DISAGREE * np.sqrt(np.mean(np.concatenate(errors) ** 2)))


def disagreement_text(common_rms: float, own_rms: float, unit: str) -> str:
    """What a zero for each run would change, and how to state it."""
    return (
        f"The runs have different zeros of the output: with a zero for each run, the rms error falls from "
        f"{common_rms:.3g} to {own_rms:.3g}{spaced(unit)}. If the zero of each file is arbitrary, "
        'write zero = "own" under '
        "[output] of the mapping and import again."
    )


def known_offset(model: Model, run: Run) -> float | None:
    """The offset from the model's output to the run's zero, or None if the record does not determine it.

    It is 0 for the training runs, for runs of the same session with the same encoder zero, for runs of the same
    absolute sensor, and for reversal curves. It is −y(initial state) for a run zeroed at power-up in a named state.
    """
    if model.temperature is not None and not driven_by_input([run]):
        return _offset_under_load(model, run)
    mine = provenance(run)
    for made_from in model.provenance:
        same_file = mine.sha256 and mine.sha256 == made_from.sha256
        if same_file and has_own_zero(run) and made_from is not model.provenance[0]:
            return None
        if same_file or share_zero(mine, made_from):
            return 0.0
    if mine.protocol == FORC_PROTOCOL:
        return 0.0
    start = recorded_start(run)
    zeroed = "" if run.info.source == "import" else "power-up"  # others zero their sensors anywhere
    if start is not None and run.info.text_of("encoder_zero", zeroed) == "power-up":
        return -model.operator().reset(start)
    return None


def _offset_under_load(model: Model, run: Run) -> float | None:
    """The offset of a model of loads of a rig: −c (σ − σ₀) of the load under which the run was zeroed, if it is known.

    Without c, it is 0 for a constant load: its zero is then that of the runs that the model was made from.
    """
    known, start_MPa = zero_slope_of(model), stress_at_start(run)
    if not _zeroed_at_power_up(model, run) or start_MPa is None:
        return None
    if known is None:
        return None if stress_at_points(run) is not None else 0.0
    slope, reference_MPa = known
    return -slope * (start_MPa - reference_MPa)


def _zeroed_at_power_up(model: Model, run: Run) -> bool:
    """Whether a run and those of a model of loads were all zeroed at power-up: each under its load, in one state."""
    mine = provenance(run)
    zeros = {mine.encoder_zero, *(p.encoder_zero for p in model.provenance)}
    return zeros == {"power-up"} and recorded_start(run) is not None and run.info.source != "import"
