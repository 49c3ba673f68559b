"""When a plain model is adequate, what an extension must beat, and which effects are not told apart."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from diagnosis.measured.independent_wire import RelayWire, as_run, triangles
from smarig.diagnosis.measured import adequacy
from smarig.diagnosis.measured.measured_diagnosis import _error_to_beat
from smarig.diagnosis.measured.measured_verdict import CONFUSED, EQUAL, _equal_ratio
from smarig.identification import compared
from smarig.measurement import input_records
from smarig.measurement.effects.input_drift import input_drift
from smarig.measurement.effects.output_drift import output_drift
from smarig.measurement.effects.output_jump import output_jump

WIRE = RelayWire(1)


def plain(peaks):
    u = triangles(peaks)
    return compared(input_records([as_run("a", u, WIRE.strain(u), dt=1.0)]), 1).evaluated([])


def with_error(base, share):
    """The model with this error on left-out blocks, in shares of the output's range."""
    size = share * np.ptp(base.fit.problem.plan.y)
    errors = np.where(np.isfinite(base.errors), size, np.nan) / base.fit.problem.weight
    return replace(base, errors=errors)


def test_left_out_segments_of_a_single_loop_are_judged_with_the_fit():
    loop, several = with_error(plain((85.0,)), 0.03), with_error(plain((85.0, 62.0, 80.0, 57.0)), 0.03)
    assert loop.fit.problem.plan.segmented
    assert not several.fit.problem.plan.segmented
    assert adequacy.is_adequate(loop)
    assert not adequacy.is_adequate(several)


def test_no_noise_makes_a_large_error_adequate(monkeypatch):
    base = plain((85.0, 62.0, 80.0, 57.0))
    monkeypatch.setattr(adequacy, "reading_noise", lambda _: 0.1 * float(np.ptp(base.fit.problem.plan.y)))
    assert adequacy.is_adequate(with_error(base, 0.04))
    assert not adequacy.is_adequate(with_error(base, 0.06))


def test_the_noise_of_a_reading_is_at_most_the_error_of_the_fit():
    base = plain((85.0, 62.0, 80.0, 57.0))
    assert adequacy.reading_noise(base) <= base.fitted_rms


def test_an_extension_must_beat_the_given_model_unless_that_knew_the_held_out_runs(monkeypatch):
    run = as_run("held", triangles((85.0,)), WIRE.strain(triangles((85.0,))))
    where = "smarig.diagnosis.measured.measured_diagnosis.file_hash"
    monkeypatch.setattr(where, lambda _: "abc")
    stranger, maker = (SimpleNamespace(provenance=[SimpleNamespace(sha256=h)]) for h in ("xyz", "abc"))
    base, given = np.full(4, 2.0), np.full(4, 1.0)
    assert _error_to_beat(base, given, stranger, [run]) == pytest.approx(1.0)
    assert _error_to_beat(base, given, maker, [run]) == pytest.approx(2.0)
    assert _error_to_beat(base, np.full(4, np.nan), stranger, [run]) == pytest.approx(2.0)


def test_drifts_of_input_and_output_are_told_apart_by_a_large_difference_only():
    def of(kind):
        return SimpleNamespace(effects=(SimpleNamespace(kind=kind),))

    assert _equal_ratio(of(input_drift), of(output_drift)) == CONFUSED
    assert _equal_ratio(of(input_drift), of(output_jump)) == EQUAL
