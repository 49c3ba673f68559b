"""Findings of the import reach the diagnosis, with matching effects; a selection limits its readings."""

from dataclasses import replace

import numpy as np
import pytest

from diagnosis.measured.independent_wire import RelayWire, as_run, triangles
from smarig.core import UsageError
from smarig.diagnosis import diagnose
from smarig.diagnosis.comparison.measured.measured_runs import selected_rows
from smarig.diagnosis.suspects import suspects
from smarig.exchange.checks.loop_faults import LoopRecord, loop_findings
from smarig.exchange.runs.reader_result import RunDraft
from smarig.exchange.runs.repair import repaired
from smarig.identification import identify
from smarig.measurement import input_records
from smarig.record import remarks

pytestmark = pytest.mark.usefixtures("few_readings")
T = triangles((85.0, 62.0, 80.0, 57.0, 85.0, 66.0), rows=40)
STRAIN = RelayWire(1).strain(T)


def with_meta(run, **meta):
    return replace(run, meta={**run.meta, **meta})


def with_findings(run, findings, **meta):
    """The run as its import would have written it."""
    stored = [f.to_json() for f in findings if f.kind]
    return with_meta(run, warnings=[f.text for f in findings], findings=stored, **meta)


def found_in(u, y):
    """What the import finds in a record."""
    return loop_findings(LoopRecord(u, y, np.arange(u.size), "degC", "%"))


def test_a_late_thermometer_and_a_lasting_strain_become_suspects_with_their_effects():
    u = triangles((85.0, 85.0), rows=100)
    leading = found_in(u, -RelayWire(1).strain(u[::-1])[::-1])
    growing = found_in(u, 4 - RelayWire(1).strain(u) + np.linspace(0, 1, u.size))
    steps = remarks("position comes in steps of 1 mm.")
    run = with_findings(as_run("a", T, STRAIN), [*leading, *growing, *steps])
    assert {s.effect for s in suspects([run])} == {"input_lag", "ratcheting"}
    assert len(suspects([run])) == len([*leading, *growing])


def test_what_was_repaired_is_no_suspect():
    lost = T.copy()
    lost[[50, 51]] = 0.0
    columns = {"input": lost, "position": STRAIN, "t_s": np.full(lost.size, np.nan)}
    draft = RunDraft(columns, {}, (), tuple(found_in(lost, STRAIN)))
    mended, _ = repaired(draft)
    before, after = (with_findings(as_run("a", lost, STRAIN), d.findings) for d in (draft, mended))
    assert [s.effect for s in suspects([before]) if "drop-outs" in s.finding] == [None]
    assert not [s for s in suspects([after]) if "drop-outs" in s.finding]
    assert set(draft.warnings) < set(mended.warnings)  # what was found is still told


@pytest.mark.long("takes three seconds")
def test_the_diagnosis_lists_suspects_and_conditions_in_its_json_and_text():
    sentence = "stress was not constant: 40 … 60, mean 50 MPa."
    stress = {"stress": {"unit": "MPa", "mean": 50.0}}
    run = with_meta(
        as_run("a", T, STRAIN), findings=[{"kind": "varying condition", "text": sentence}], conditions=stress
    )
    model = identify(as_run("m", T, STRAIN, stress=80.0), "positive").model
    found = diagnose(model, [run])
    assert found.to_json()["suspects"] == [{"run": "a", "finding": sentence, "effect": "stress_shift"}]
    assert found.to_json()["conditions"] == [
        "The run was made under 50 MPa, the model from runs under 80 MPa."
    ]
    listed = f"The import of a found: {sentence} It would match stress_shift"
    assert suspects([run])[0].text() == f"{listed}."
    assert f"{listed}, which these data cannot show." in found.text()  # one stress only


def test_a_suspect_that_these_data_cannot_show_is_stated_as_such():
    sentence = "At the low end of the input the output goes 1 → 2 % over 2 visits: the loop does not close."
    two = triangles((85.0,), rows=80)  # one cycle: a strain that remains from cycle to cycle cannot show
    run = with_meta(
        as_run("a", two, RelayWire(1).strain(two)), findings=[{"kind": "open loop", "text": sentence}]
    )
    found = diagnose(identify(run, "positive").model, [run])
    assert "ratcheting" in found.not_testable
    assert f"The import of a found: {sentence} It would match ratcheting, which these data cannot show." in (
        found.text()
    )


@pytest.fixture
def forc():
    """Descending curves from each peak, as rows of a measured input."""
    return as_run("forc", T, 4 - STRAIN)


@pytest.mark.long("takes two seconds")
def test_a_selection_keeps_only_readings_of_those_curves(forc):
    (even,) = selected_rows([forc], input_records([forc]), "alpha > 70")
    assert 0 < even.sum() < len(T)
    model = identify(forc, "positive").model
    some, every = diagnose(model, [forc], select="alpha > 70"), diagnose(model, [forc])
    rows = some.comparison.plan.rows[0]
    assert even[rows].all()
    assert 0 < rows.size < every.comparison.plan.rows[0].size
    with pytest.raises(UsageError, match="no point"):
        diagnose(model, [forc], select="curve > 99")
