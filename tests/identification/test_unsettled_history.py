"""Models with effects on runs without settled points: an initialisation is history, not an error."""

import json

import numpy as np
import pytest

from smarig.identification import identify, verify
from smarig.record import load_run
from smarig.replay import load_model
from smarig.runner import Session


@pytest.fixture(scope="module")
def session(tmp_path_factory):
    folder = tmp_path_factory.mktemp("session")
    quick = {"partition_K": (20.0, 60.0, 100.0, 140.0)}
    plan = [("initialise", {}), ("first_order_descending", quick), ("validation", {"points": 4})]
    with Session("one_wire_twin") as opened:
        for name, settings in plan:
            opened.run(name, settings, folder / f"{name}.run.sqlite")
    return [load_run(folder / f"{name}.run.sqlite") for name, _ in plan]


@pytest.mark.long("takes three seconds")
def test_an_initialisation_is_part_of_the_history(session, tmp_path):
    initialisation, curves, _ = session
    assert not initialisation.settled
    model = identify(curves, surface="exponential").model
    assert len(verify(model, session).runs) == 3, "without effects its readings are judged"
    file = tmp_path / "extended.model.json"
    model.save(file)
    data = json.loads(file.read_text())
    data["effects"] = [{"name": "backlash", "parameters": {"play_percent": 0.3}}]
    file.write_text(json.dumps(data))
    found = verify(load_model(file), session)
    assert [run.run for run in found.runs] == [str(run.path) for run in session[1:]]
    assert np.isfinite([run.settled.rms for run in found.runs]).all()
    alone = verify(load_model(file), session[2])
    assert not [w for w in alone.runs[0].warnings if "neither given nor found" in w], (
        "the curves begin its history"
    )
