"""Loops with two or three readings in the transformation: a curve is as steep as the chord of two of them."""

import numpy as np
import pytest

from smarig.core import UsageError
from smarig.study import StudyOptions, study
from smarig.transformation import TEMPERATURES, run_figures
from transformation.known_loops import known_loop, run_of

MANY = pytest.mark.long("takes half a minute")


def thinned(loop, seed):
    """Readings of a loop about a quarter to three fifths of its span apart."""
    dice = np.random.default_rng([7, seed])
    step, top = dice.uniform(0.25, 0.6) * loop.span, int(np.argmax(loop.u))
    kept = []
    for begin, end in ((0, top + 1), (top + 1, loop.u.size)):
        way, due = np.abs(loop.u[begin:end] - loop.u[begin]), dice.uniform(0, step)
        kept += [begin, end - 1]
        for k in range(end - begin):
            if way[k] >= due:
                kept.append(begin + k)
                due = way[k] + step * dice.uniform(0.7, 1.3)
    kept = np.unique(kept)
    return run_of(loop.u[kept], loop.y[kept])


def errors_in_spans(seeds, kind):
    """Errors (loops, 4) of the temperatures in spans, of the loops that have all four."""
    errors = []
    for seed in seeds:
        loop = known_loop(seed, kind=kind, noise=0.002)
        try:
            found = run_figures(thinned(loop, seed)).means
        except UsageError:
            continue
        if set(TEMPERATURES) <= set(found):
            errors.append([(found[name].value - loop.truth[name]) / loop.span for name in TEMPERATURES])
    return np.array(errors)


@pytest.mark.parametrize(
    ("kind", "seeds"),
    [
        pytest.param("logistic", range(24)),
        pytest.param("logistic", range(100, 200), marks=MANY),
        pytest.param("normal", range(100, 200), marks=MANY),
    ],
)
def test_no_tangent_is_far_flatter_than_the_curve_between_two_readings(kind, seeds):
    """With lines through the nearest three readings alone, errors of a whole span occur."""
    errors = errors_in_spans(seeds, kind)
    assert len(errors) > 0.3 * len(seeds)
    assert np.sqrt(np.mean(errors**2)) < 0.11
    assert np.abs(errors).max() < 0.5


def test_a_digitised_loop_agrees_with_tangents_by_hand(shared_data, tmp_path):
    """NiTiHf, 28 readings a branch: through the two steepest neighbours, by hand, as the note beside the data says."""
    folder = shared_data / "field_cases" / "tangent_of_a_coarse_branch"
    if not folder.is_dir():
        pytest.skip(f"no folder {folder.name} with others' measurements")
    files = [folder / f"NiTiHf_{stress}MPa.txt" for stress in (100, 200, 300)]
    found = study(files, tmp_path / "out", StudyOptions(diagnose=False)).transformation.result
    by_hand = {"A_s": (158.5, 160.8, 165.0), "A_f": (174.8, None, None)}
    for name, values in by_hand.items():
        for run, value in zip(found.runs, values, strict=True):
            if value is not None:
                low, high = run.means[name].ci95
                assert low <= value <= high
                assert run.means[name].value == pytest.approx(value, abs=2.0)


def test_two_readings_in_the_transformation_are_refused():
    """They lie on a line whatever the curve: nothing shows where it bends."""
    u = np.concatenate([np.linspace(0, 40, 12), [49.0, 51.5], np.linspace(60, 100, 12)])
    y = np.concatenate([np.zeros(12), [0.3, 0.7], np.ones(12)])
    with pytest.raises(UsageError, match="fewer than three of its readings lie in the transformation"):
        run_figures(run_of(np.concatenate([u, u[::-1]]), np.concatenate([y, y[::-1]])))
