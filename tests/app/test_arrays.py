"""What someone who knows NumPy tries first: arrays, runs and paths in, arrays out, or what to call instead."""

import hashlib

import numpy as np
import pytest

import smarig
from preisach.relay_reference import Relays
from smarig.core import DataError, UsageError


def relay_wire(u, seed=3):
    """Outputs of 3000 relays along inputs: no code of the package."""
    dice = np.random.default_rng(seed)
    up, down = np.sort(dice.normal([62.0, 48.0], 9.0, (3000, 2)), axis=1)[:, ::-1].T
    return Relays(up, down, np.full(up.size, 1 / 300), np.zeros(up.size, bool), u[0]).drive(u, 0.0)


def path(*ends):
    return np.concatenate([np.linspace(a, b, 60) for a, b in zip(ends, ends[1:])])


TRAIN = path(10, 100, 10, 80, 35, 70, 42, 90, 30, 60, 10, 65, 10)
TEST = path(10, 75, 40, 62, 10, 100, 45, 85, 10)


@pytest.fixture(scope="module")
def runs(tmp_path_factory):
    folder = tmp_path_factory.mktemp("runs")
    names = {"first_order_descending": {}, "validation": {"points": 6}}
    return [
        smarig.run(n, rig="one_wire_twin", out=folder / f"{n}.run.sqlite", seed=k, **s)
        for k, (n, s) in enumerate(names.items())
    ]


def test_two_arrays_make_a_model_that_predicts_others():
    noise = np.random.default_rng(0).normal(0, 0.02, TRAIN.size)
    model = smarig.fit(TRAIN, relay_wire(TRAIN) + noise, unit="mm")
    truth = relay_wire(TEST)
    error = model.predict(TEST) - truth
    assert np.std(error) < 0.03 * np.ptp(truth)
    assert smarig.simulate(model, TEST).tolist() == model.predict(TEST).tolist()
    assert model.unit == "mm"


def test_a_missing_reading_of_an_array_is_left_out_and_times_may_be_stated():
    y = relay_wire(TRAIN)
    y[17] = np.nan
    model = smarig.fit(TRAIN, y, np.arange(TRAIN.size) * 0.1)
    assert np.isfinite(model.predict(TEST)).all()


def test_a_model_is_simulated_along_arrays_batches_runs_and_paths(runs, tmp_path):
    fod, validation = runs
    found = smarig.identify(fod)
    saved = found.model.save(tmp_path / "m.json")
    along = smarig.simulate(found, validation)
    for model in (found.model, saved, str(saved)):
        assert smarig.simulate(model, validation.path).tolist() == along.tolist()
    assert along.shape == (len(validation),)
    assert np.sqrt(np.nanmean((along - validation["position"]) ** 2)) < 0.1  # mm, of 12; one zero, one twin
    batch = np.stack([TEST, TEST[::-1]])
    assert smarig.simulate(found.model, batch).shape == batch.shape
    assert smarig.simulate(found, TEST, "positive")[0] != smarig.simulate(found, TEST)[0]


def test_what_identify_returns_is_verified(runs):
    found = smarig.identify(runs[0])
    assert str(smarig.verify(found, runs[1])) == str(smarig.verify(found.model, runs[1]))


def test_a_wrong_call_says_which_is_right(runs):
    model = smarig.identify(runs[0]).model
    for run in (runs[1], runs[1].path, str(runs[1].path)):
        with pytest.raises(UsageError, match=r"call smarig\.simulate\(model, run\)"):
            model.predict(run)
    for arrays in ((TRAIN, TEST), (TRAIN,)):
        with pytest.raises(UsageError, match=r"call smarig\.fit\(u, y\)"):
            smarig.identify(*arrays)
    with pytest.raises(UsageError, match=r"rows of equal length, got the shapes \(5,\), \(4,\)"):
        smarig.fit(np.zeros(5), np.zeros(4))
    with pytest.raises(DataError):
        smarig.fit([1.0, 2.0], [0.0, 1.0])
    with pytest.raises(DataError, match="3 readings or more of input and output, got 0"):
        smarig.fit(TRAIN, np.full(TRAIN.size, np.nan))
    with pytest.raises(UsageError, match="fit needs a one-dimensional output of numbers"):
        smarig.fit(TRAIN, ["a"] * TRAIN.size)
    with pytest.raises(DataError):
        smarig.fit(TRAIN, np.zeros(TRAIN.size))  # it does not move


def test_loops_and_certificates_take_models_results_and_paths(runs, tmp_path):
    found = smarig.identify(runs[0])
    saved = found.model.save(tmp_path / "m.json")
    t_s, position = [0.0, 2.0, 4.0], [3.0, 5.0, 5.0]
    tracked = [
        smarig.track(model, wanted, rig="one_wire_twin", out=tmp_path / f"{k}.run.sqlite")
        for k, (model, wanted) in enumerate([(found, np.array([t_s, position])), (saved, (t_s, position))])
    ]
    assert tracked[0]["position"].tolist() == tracked[1]["position"].tolist()
    hashes = {run.info.settings["model_sha256"] for run in tracked}
    assert hashes == {hashlib.sha256(saved.read_bytes()).hexdigest()}
    held = smarig.regulate(found.model, 6.0, rig="one_wire_twin", out=tmp_path / "r.run.sqlite", hold_s=1.0)
    assert held.cause == "done"
    certified = [smarig.certify(model).text for model in (found, found.model, saved)]
    assert len(set(certified)) == 1
    assert "issipa" in certified[0]


def test_a_reference_that_is_none_says_what_one_is(runs, tmp_path):
    model, on = smarig.identify(runs[0]), {"rig": "one_wire_twin", "out": tmp_path / "t.run.sqlite"}
    with pytest.raises(UsageError, match="two rows of numbers: times in s from 0, and positions"):
        smarig.track(model, np.zeros(5), **on)
    with pytest.raises(UsageError, match="times must start at 0 and increase"):
        smarig.track(model, [[1.0, 2.0], [3.0, 5.0]], **on)
    with pytest.raises(UsageError, match="apply to steps, ramps and multisine only"):
        smarig.track(model, [[0.0, 2.0], [3.0, 5.0]], **on, seconds=5)
    assert not on["out"].exists()


@pytest.mark.parametrize("shape", ["steps", "ramps"])
def test_a_tracked_run_has_its_reference_as_a_column(runs, tmp_path, shape):
    model, on = smarig.identify(runs[0]), {"rig": "one_wire_twin", "out": tmp_path / "t.run.sqlite"}
    run = smarig.track(model, shape, **on, seconds=60, every_s=15, low=3.0, high=6.0)
    closed = np.isfinite(run["reference"])
    known = run["reference"][closed]
    assert 59 < np.ptp(run["t_s"][closed]) < 61
    assert np.count_nonzero(np.abs(np.diff(known)) > 1e-9) == (3 if shape == "steps" else known.size - 1)
    assert 3.0 <= known.min() < known.max() <= 6.0
    assert 0.0 < np.sqrt(np.mean((run["position"][closed] - known) ** 2)) < 1.0
    with pytest.raises(UsageError, match="has no column 'reference'"):
        runs[0]["reference"]


def test_what_is_printed_is_short_and_what_is_tried_first_works(runs):
    found = smarig.identify(runs[0])
    assert len(repr(runs[0].info)) < 2500
    assert found.predict(TEST).tolist() == found.model.predict(TEST).tolist()
    with pytest.raises(UsageError, match=r"Call operator\(\) of a model"):
        smarig.Preisach(found.model)
