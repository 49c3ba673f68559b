"""From a recorded run to a verified model, on the twin and on magnetic data of others."""

import json

import numpy as np
import pytest

from smarig.exchange.importing import import_file
from smarig.identification.identify import identify
from smarig.identification.verify import verify
from smarig.preisach.hysteresis.gorbet_1997 import thesis_surface
from smarig.record import load_run
from smarig.replay import load_model
from smarig.runner.session import Session


@pytest.fixture(scope="module")
def session_folder(tmp_path_factory):
    """FOD data and a validation run of the two-wire twin, initialised, in one session."""
    folder = tmp_path_factory.mktemp("sitting")
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("SMARIG_LOCK_DIR", str(folder / "locks"))
        with Session("two_wire_twin", seed=3) as session:
            session.run("initialise", {}, folder / "initialise.run.sqlite")
            for protocol in ("first_order_descending", "validation"):
                session.run(protocol, {}, folder / f"{protocol}.run.sqlite")
    return folder


@pytest.mark.long("the whole way, as the README's first command goes it")
def test_twin_to_model_to_verification(session_folder, tmp_path):
    fod = session_folder / "first_order_descending.run.sqlite"
    result = identify(str(fod), "best")
    assert result.surface == "exponential"
    assert len(result.data) == 77
    assert np.allclose(result.fit.values[:6], thesis_surface("two_e").x, rtol=0.01)
    assert result.curves.exercised
    model = load_model(result.model.save(tmp_path / "wire.model.json"))
    assert model.provenance[0].sha256
    assert model.actuator.name == "gorbet_two_wire"
    verified = verify(model, load_run(session_folder / "validation.run.sqlite"))
    (run,) = verified.to_json()["runs"]
    json.dumps(run, allow_nan=False)
    assert run["offset_kind"] == "known"  # same session, same encoder zero
    assert run["rms"] < 0.05  # deg; one count is 0.18
    assert run["nrmse"] < 0.002
    assert run["transient"]["n"] > 10_000
    assert run["transient"]["nrmse"] < 0.01


@pytest.mark.long("takes five seconds")
def test_a_model_of_another_form_is_distinguished(session_folder):
    runs = [load_run(session_folder / f"{p}.run.sqlite") for p in ("first_order_descending", "validation")]
    errors = {
        k: verify(identify(runs[0], k).model, runs[1]).runs[0].settled.rms
        for k in ("constant", "exponential")
    }
    assert errors["constant"] > 10 * errors["exponential"]


@pytest.mark.long("takes two seconds", cases=("UB199BF",))
@pytest.mark.parametrize(
    "name",
    [
        "MSM33-55-1_d330.forc",
        "UB199BF",
        pytest.param("hchb_forc", marks=pytest.mark.long("takes three seconds")),
    ],
)
def test_even_reversal_curves_predict_the_odd_ones(shared_data, tmp_path, name):
    path = tmp_path / "forc.run.sqlite"
    import_file(shared_data / "forc_magnetic" / name, format="forc", out=path)
    run = load_run(path)
    table = identify(run, "table", select="curve%2==0").model
    odd = verify(table, run, select="curve%2==1").runs[0]
    assert table.mirrored
    assert odd.offset == 0.0
    assert odd.settled.n > 4000
    assert odd.settled.nrmse < 1e-3
