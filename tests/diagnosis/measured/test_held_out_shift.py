"""Held-out runs that differ from the training runs are a finding; those that only reach beyond them are not."""

from dataclasses import replace

import numpy as np

from diagnosis.measured.independent_wire import RelayWire, as_run, triangles
from smarig.diagnosis.diagnosis_verdict import DiagnosisVerdict
from smarig.diagnosis.measured.adequacy import noise_by_differences
from smarig.diagnosis.measured.held_out_shift import held_out_shift, with_held_out_shift
from smarig.identification import compared
from smarig.measurement import input_records

PEAKS = (85.0, 62.0, 80.0, 57.0, 85.0, 66.0)
T = triangles(PEAKS)
WIRE = RelayWire(1)


def shift_of(other, dt=1.0):
    """What a held-out run differs in, with an error of twenty times that on left-out blocks."""
    records = input_records([as_run("train", T, WIRE.strain(T), dt=1.0), other])
    comparison = compared(records, 1)
    base = comparison.evaluated([])
    error = np.where(comparison.train, base.fit.error, 20 * base.rms + 0.1 * np.ptp(comparison.plan.y))
    return held_out_shift(base, error, comparison, 1)


def test_a_run_that_is_missed_by_far_more_than_left_out_blocks_differs():
    found = shift_of(as_run("other", T, WIRE.strain(T), dt=1.0))
    assert found is not None
    assert found.variable == "run"
    assert found.ratio > 20
    silent = DiagnosisVerdict("silent")
    assert with_held_out_shift(silent, found) == DiagnosisVerdict("unknown", depends_on="run")
    assert with_held_out_shift(silent, None) is silent


def test_a_run_at_another_rate_differs_in_its_rate():
    found = shift_of(as_run("fast", T, WIRE.strain(T), dt=0.1))
    assert found is not None
    assert found.variable == "rate"


def test_a_run_that_reaches_beyond_the_training_inputs_is_no_finding():
    hotter = triangles((110.0, 62.0, 80.0))
    found = shift_of(as_run("hotter", hotter, WIRE.strain(hotter), dt=1.0))
    assert found is None


def test_a_named_cause_stays():
    found = shift_of(as_run("other", T, WIRE.strain(T), dt=1.0))
    named = DiagnosisVerdict("named", ((("input_lag",), 1.0),))
    assert with_held_out_shift(named, found) is named
    depends = replace(DiagnosisVerdict("unknown"), depends_on="cycle")
    assert with_held_out_shift(depends, found) is depends


def test_the_noise_of_a_record_is_neither_its_curvature_nor_its_jumps():
    rng = np.random.default_rng(3)
    x = np.linspace(0, 20, 400)
    assert 0.8 * 0.02 < noise_by_differences(np.sin(x) + 0.02 * rng.standard_normal(400)) < 1.3 * 0.02
    coarse = np.sin(np.linspace(0, 60, 300))
    assert noise_by_differences(coarse) < 0.003
