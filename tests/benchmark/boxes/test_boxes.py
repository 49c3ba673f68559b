"""Sealed boxes as they are drawn, written and read: categories, determinism, no trace of the label,
identification."""

import sqlite3
from collections import Counter
from contextlib import closing

import numpy as np
import pytest

import smarig
from benchmarks.boxes import Label, draw_box, write_box
from benchmarks.boxes.box_effects import EFFECTS
from smarig.core.errors import UsageError
from smarig.replay import memory_histories

EVERY = ("transients", "current", "voltage", "ambient")


@pytest.fixture(scope="module")
def sealed(tmp_path_factory):
    return write_box(
        draw_box(1, 2, hidden={"stress_coupling": {"shift_K": 6.0}}, channels=EVERY),
        tmp_path_factory.mktemp("a"),
    )


def loaded(sealed):
    paths = sorted((*sealed.train, *sealed.held_out), key=lambda path: path.name)
    return [smarig.load_run(path) for path in paths]


def samples(path):
    with closing(sqlite3.connect(path)) as db:
        return [db.execute(f"SELECT * FROM {table}").fetchall() for table in ("sample", "step")]


@pytest.mark.long
def test_the_mix_and_the_strengths():
    seen, hidden = Counter(), set()
    for box in (draw_box(5, k) for k in range(600)):  # one at a time: together they hold 600 MB
        seen.update([box.category], left_out=bool(box.left_out), two_wire=box.wire.two_wire)
        hidden |= set(box.hidden)
        assert 250 <= sum(len(run.holds) for run in box.plan) <= 420
        assert 20_000 * 0.9 <= box.hysteresis.alpha.size <= 60_000
        assert np.all(box.hysteresis.alpha >= box.hysteresis.beta)
        assert box.hysteresis.upper < box.wire.reference_K
        assert box.hysteresis.lower > (-box.wire.reference_K if box.wire.two_wire else 0)
        for name, values in box.hidden.items():
            effect = EFFECTS[name]
            assert effect.lower <= values[effect.strength] <= effect.upper
            assert 0.24 <= abs(values[effect.strength] / effect.typical) <= 2.01
            assert effect.only in ("", box.wire.arrangement)
    assert seen["empty"] + seen["hard_null"] == pytest.approx(210, abs=45)
    assert seen["hard_null"] == pytest.approx(70, abs=30)
    assert seen["two"] == pytest.approx(90, abs=35)
    assert seen["left_out"] == pytest.approx(30, abs=20)
    assert seen["two_wire"] == pytest.approx(120, abs=40)
    assert hidden == set(EFFECTS)


def test_forcing_leaves_the_rest_of_the_box_as_it_is():
    plain, forced = (
        draw_box(3, 4),
        draw_box(3, 4, hidden={"walking": {"percent_per_cycle": 1.0}}, channels=()),
    )
    assert plain.wire == forced.wire
    assert plain.plan == forced.plan or plain.category == "hard_null"
    assert (forced.category, forced.channels) == ("one", ())
    assert draw_box(3, 4, hidden={}).category == "empty"
    assert draw_box(3, 4, hidden="hard_null").category == "hard_null"


@pytest.mark.long
def test_the_same_seed_gives_the_same_samples(sealed, tmp_path):
    again = write_box(draw_box(1, 2, hidden={"stress_coupling": {"shift_K": 6.0}}, channels=EVERY), tmp_path)
    for one, other in zip((*sealed.train, *sealed.held_out), (*again.train, *again.held_out)):
        assert one.name == other.name
        assert samples(one) == samples(other)
    assert again.commitment == sealed.commitment
    assert draw_box(1, 3).wire != draw_box(1, 2).wire


@pytest.mark.long("takes three seconds")
def test_the_files_do_not_reveal_what_is_hidden(sealed):
    words = [name.encode() for name in EFFECTS]
    words += [b"effects", b"seed", b"stress", b"shift_K", sealed.commitment.encode()]
    for path in (sealed.actuator, *sealed.train, *sealed.held_out):
        content = path.read_bytes()
        assert not [word for word in words if word in content]


def test_one_session_with_one_clock(sealed):
    runs = loaded(sealed)
    assert [run.meta["initial"] for run in runs] == ["negative", *["continued"] * (len(runs) - 1)]
    assert len({(run.meta["start_epoch"], run.meta["encoder_zero"]) for run in runs}) == 1
    for before, run in zip(runs, runs[1:]):
        assert run["t_s"][0] == pytest.approx(before["t_s"][-1] + 0.1)
    _, _, found = memory_histories(runs)
    assert all(state is not None for history in found for state in history.states)
    assert [run.path.name[:3] for run in runs] == [f"{k:02d}_" for k in range(1, len(runs) + 1)]


def test_steps_are_means_of_their_windows(sealed):
    run = loaded(sealed)[0]
    for step in run.settled:
        window = run["position"][run["step"] == step.index][-step.n :]
        assert step.position == pytest.approx(window.mean(), abs=1e-9)
        last = run["input"][run["step"] == step.index][-1]
        assert last == pytest.approx(step.target, abs=0.02)


@pytest.mark.long("takes a second", cases=("11",))
@pytest.mark.parametrize("number", [2, 11])
def test_channels_that_were_not_recorded_are_absent(number, tmp_path):
    sealed = write_box(draw_box(1, number, hidden={}, channels=()), tmp_path)
    for run in loaded(sealed):
        assert len(run) == len(run.steps) + 1
        assert not (run.has("current_A"))
        assert not (run.has("voltage_V"))
        assert not (run.has("ambient_degC"))
        assert run.has("current_command_A")
    _, _, found = memory_histories(loaded(sealed))
    assert all(state is not None for history in found for state in history.states)


def test_the_label_survives_json(sealed):
    label = sealed.label
    assert Label.from_json(label.to_json()) == label
    assert len(sealed.commitment) == 64
    assert label.effects == {"stress_coupling": {"shift_K": 6.0}}
    by_name = {path.name[3:].split(".")[0]: path for path in (*sealed.train, *sealed.held_out)}
    for truth in label.runs:
        settled, y = smarig.load_run(by_name[truth.name]).points()
        assert settled.tolist() == list(truth.targets)
        error = (y - np.array(truth.with_effects)) / label.per_count
        assert np.abs(error - error.mean()).max() < 8 * label.noise_counts + 1
        assert np.ptp(truth.with_effects) > 1
        assert np.ptp(np.subtract(truth.with_effects, truth.without)) > 0.1


def test_an_empty_box_is_within_its_noise(tmp_path):
    label = write_box(draw_box(1, 9, hidden={}), tmp_path).label
    assert all(truth.with_effects == truth.without for truth in label.runs)


def test_the_estimator_learns_from_a_box(sealed):
    found = smarig.identify(loaded(sealed)[: len(sealed.train)], surface="table")
    assert found.data.curves >= 8
    assert found.model.fit["rms"] < 0.05 * np.ptp(sealed.label.runs[0].with_effects)


@pytest.mark.parametrize(
    ("hidden", "channels"),
    [({"ghost": {}}, None), ({"walking": {"size": 1.0}}, None), ({}, ["radio"]), ("nothing", None)],
)
def test_what_cannot_be_drawn_is_refused(hidden, channels):
    with pytest.raises(UsageError):
        draw_box(1, 2, hidden=hidden, channels=channels)
    with pytest.raises(UsageError):
        draw_box(-1, 2)
