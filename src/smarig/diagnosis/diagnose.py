"""The diagnosis of any runs: of a rig's settled steps, or of data of others that have only a measured input."""

from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
from threadpoolctl import threadpool_limits

from smarig.core import DataError, UsageError
from smarig.diagnosis.comparison.commanded.commanded_comparison import diagnose_commanded
from smarig.diagnosis.comparison.commanded.commanded_diagnosis import CommandedDiagnosis
from smarig.diagnosis.comparison.measured.measured_diagnosis import MeasuredDiagnosis, diagnose_measured
from smarig.diagnosis.run_checks import check_comparable, check_held_out, check_left_out, check_settings
from smarig.measurement import has_measured_input, measurement_effect_types
from smarig.plant import effect_types
from smarig.record import Run, Runs, loaded_runs
from smarig.replay import Model, driven_by_input, load_model


@threadpool_limits.wrap(limits=1, user_api="blas")
def diagnose(
    model: Model | str | Path,
    train: Runs,
    held_out: Runs = (),
    *,
    alpha: float = 0.03,
    nulls: int = 400,
    seed: int = 0,
    without: Sequence[str] = (),
    select: str | None = None,
    progress: Callable[[str], None] | None = None,
) -> CommandedDiagnosis | MeasuredDiagnosis:
    """Diagnose a model on runs of one wire: what it predicts wrongly, why, and what an extended model gains.

    Runs with currents and settled steps are diagnosed by ``diagnose_commanded``. Runs that have only a measured input,
    and settled steps of a wire without known constants, are diagnosed by ``diagnose_measured``. ``seed`` is that of the
    resampling of blocks. ``alpha`` and ``nulls`` have no effect: no null data are drawn. ``select`` keeps the points of
    runs with a measured input for which an expression on curve, alpha, beta holds. Raises DataError if the runs hold
    nothing to diagnose or overlap, and UsageError for invalid settings.
    """
    check_settings(alpha, nulls, seed)
    original = model if isinstance(model, Model) else load_model(model)
    train_runs, held_out_runs = loaded_runs(train), loaded_runs(held_out)
    if train_runs and not original.actuator.parameters:
        train_runs, held_out_runs = _by_input(train_runs), _by_input(held_out_runs)
    if not train_runs or not driven_by_input(train_runs):
        if select is not None:
            raise UsageError("A selection of points needs runs with a measured input, not runs of a rig.")
        if held_out_runs and not any(run.settled for run in held_out_runs):
            names = ", ".join(run.path.name for run in held_out_runs)
            raise DataError(
                f"The held-out runs contain no settled steps. In place of {names}, hold out a run whose protocol waits "
                "at each input, such as validation, or none."
            )
        return diagnose_commanded(
            original, train_runs, held_out_runs, seed=seed, without=without, progress=progress
        )
    check_comparable(original, [*train_runs, *held_out_runs])
    check_held_out(train_runs, held_out_runs)
    check_left_out(without, [k.name for k in (*effect_types(), *measurement_effect_types())])
    return diagnose_measured(
        original, train_runs, held_out_runs, without, progress or (lambda _: None), select, seed
    )


def _by_input(runs: Sequence[Run]) -> list[Run]:
    """Runs whose settled points are their rows and whose targets are a measured input: the heating is not known.

    The current of a run without settled points is its input, and no more.
    """
    return [_points_as_rows(run) if run.settled else _without_current(run) for run in runs]


def _without_current(run: Run) -> Run:
    """The run without its currents, if their heating of the wire is not known; its input may be that current."""
    if has_measured_input(run) or not run.has("input"):
        return run
    blank = {name: np.full(len(run), np.nan) for name in ("current_A", "current_command_A")}
    return replace(run, columns={**run.columns, **blank})


def _points_as_rows(run: Run) -> Run:
    (u, y), ends_s = run.points(), [s.end_s for s in run.settled]
    columns = {name: np.full(u.size, np.nan) for name in run.columns}
    columns |= {"tick": np.arange(u.size, dtype=float), "input": u, "position": y}
    if run.has("t_s"):
        columns["t_s"] = np.array(ends_s, dtype=float)
    return replace(run, columns=columns, steps=())
