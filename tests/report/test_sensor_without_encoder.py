"""A sensor that reads a length and keeps its zero: no word of an encoder wheel or a zero at power-up."""

import pytest

from identification.made_runs import fod_run
from smarig.diagnosis.effects_to_try import effects_to_try
from smarig.identification import identify
from smarig.replay import plant_model_of
from smarig.report.runs.run_tables import conditions_table


@pytest.fixture(scope="module")
def run():
    return fod_run("one_e", seed=1, encoder_zero="power-up", actuator="gorbet_one_wire")


@pytest.mark.parametrize("zero", ["power-up", "absolute: LT-50 laser", "zeroed at 60 s"])
def test_the_zero_of_a_run_is_named(run, zero):
    row = str(conditions_table(run.with_meta(encoder_zero=zero))).split("Encoder zero")[1].split("</tr>")[0]
    assert zero in row


@pytest.mark.parametrize(
    ("encoder", "offered"),
    [({"counts_per_rev": 2000}, True), ({"counts_per_rev": 2000, "resolution": 0.02}, False)],
)
def test_what_needs_an_encoder_wheel_is_no_candidate_of_a_linear_sensor(run, encoder, offered):
    of_rig = run.with_meta(rig_values={"encoder": encoder})
    model = plant_model_of(identify(run, "positive").model, of_rig)
    names = {kind.name for kind in effects_to_try(model, of_rig)}
    assert ("eccentricity" in names) == offered
    assert {"slip", "backlash", "noncongruency"} <= names


def test_a_rotary_sensor_with_a_resolution_in_degrees_has_a_wheel(run):
    turns = run.with_meta(
        rig_values={"encoder": {"resolution": 0.1}}, output={"quantity": "angle", "unit": "deg"}
    )
    model = plant_model_of(identify(run, "positive").model, run)
    assert "eccentricity" in {kind.name for kind in effects_to_try(model, turns)}
