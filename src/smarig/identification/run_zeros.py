"""The zeros of outputs that are fitted together: common to all runs, or one for each run whose file has its own."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from smarig.core import spaced
from smarig.identification.positive.observations import COMMON, Observations
from smarig.record import FORC_PROTOCOL, OWN_ZERO, Run
from smarig.replay import Model, simulate_runs

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
