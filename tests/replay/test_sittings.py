"""Several sessions in one timeline: each is simulated on its own clock and from its own zero."""

from dataclasses import replace

import numpy as np
import pytest

from replay.sittings import LISTED, LONG, session_runs, twin_plant_model
from smarig.core.errors import DataError
from smarig.diagnosis.refit.memory_noise import memory_covariance, memory_slopes
from smarig.diagnosis.refit.refit import refit
from smarig.plant.effect_catalogue import effects_from_pairs
from smarig.replay import OUTPUT_DEPENDENT_KINDS, build_timeline, predict

TAU_S = 5.3
FEW = ("step_currents", {"temperatures_K": (0.0, 75.0, 30.0, 95.0, 20.0)})
SHIFT_MM = 1.0


@pytest.fixture(scope="module")
def apart(tmp_path_factory):
    """The runs of two sessions; the second is longer."""
    return [
        session_runs(tmp_path_factory.mktemp("sittings"), *protocols, seed=seed)
        for seed, protocols in enumerate([(LISTED, FEW), (LONG, LISTED)])
    ]


@pytest.fixture(scope="module")
def joined_timeline(apart):
    return build_timeline([run for runs in apart for run in runs], TAU_S)


def with_columns(run, **columns):
    return replace(run, columns=run.columns | columns)


def with_shifted_zero(run, by):
    """The run with another zero of its encoder."""
    steps = tuple(replace(s, position=s.position + by) for s in run.steps)
    return replace(with_columns(run, position=run["position"] + by), steps=steps)


@pytest.mark.long("takes two seconds")
def test_a_joined_timeline_holds_every_sessions_readings_in_turn(apart, joined_timeline):
    alone = [build_timeline(runs, TAU_S) for runs in apart]
    assert len(joined_timeline.sessions) == 2
    assert joined_timeline.zero.tolist() == [0] * len(alone[0].settled) + [1] * len(alone[1].settled)
    assert joined_timeline.duration_h == max(timeline.duration_h for timeline in alone)
    for r in joined_timeline.all_readings:
        own = [q for timeline in alone for q in timeline.all_readings if q.kind == r.kind]
        assert r.value.tolist() == [v for q in own for v in q.value.tolist()]
        assert np.all(np.diff(r.t_s) > 0)
    for name in ("target_K", "hold_s"):
        assert getattr(joined_timeline, name).tolist() == [
            v for s in alone for v in getattr(s, name).tolist()
        ]
    assert joined_timeline.run.tolist() == [
        k for k, run in enumerate(joined_timeline.runs) for _ in run.settled
    ]
    assert not set(joined_timeline.block[joined_timeline.zero == 0]) & set(
        joined_timeline.block[joined_timeline.zero == 1]
    )


@pytest.mark.long("takes three seconds")
def test_sessions_are_joined_in_the_order_in_which_they_began(apart, joined_timeline):
    again = build_timeline([run for runs in apart[::-1] for run in runs], TAU_S)
    assert again.settled.value.tolist() == joined_timeline.settled.value.tolist()


@pytest.mark.long("takes two seconds")
def test_one_session_is_no_joined_timeline(apart):
    alone = build_timeline(apart[0], TAU_S)
    assert alone.sessions == ()
    assert alone.zero.size == 0


@pytest.mark.parametrize(
    "effects", [(), ("walking=1",), ("settling=5",), ("ambient_drift=2", "ambient_drift.period_h=0.3")]
)
def test_a_joined_timeline_is_predicted_as_its_sessions_are(apart, joined_timeline, effects):
    plant_model, _ = twin_plant_model(effects)
    whole = predict(joined_timeline, plant_model)
    alone = [
        (timeline, predict(timeline, plant_model))
        for timeline in (build_timeline(runs, TAU_S) for runs in apart)
    ]
    for r in joined_timeline.all_readings:
        parts = [part.values[r.kind] for _, part in alone if r.kind in part.values]
        assert whole.values[r.kind].tolist() == np.concatenate(parts).tolist()
    order = [
        (timeline, part, kind)
        for kind in OUTPUT_DEPENDENT_KINDS
        for timeline, part in alone
        if kind in part.values
    ]
    for name in ("output", "output_slope", "states"):
        parts = [list(getattr(part, name)[part.of(kind)]) for _, part, kind in order]
        assert list(getattr(whole, name)) == [v for part in parts for v in part]
    assert whole.session.tolist() == [
        k
        for kind in OUTPUT_DEPENDENT_KINDS
        for k, (_, part) in enumerate(alone)
        for _ in part.values.get(kind, ())
    ]


def test_a_predictions_tick_indices_are_the_times_of_its_readings(joined_timeline):
    whole = predict(joined_timeline, twin_plant_model()[0])
    coupled = [r for r in joined_timeline.all_readings if r.kind in OUTPUT_DEPENDENT_KINDS]
    np.testing.assert_allclose(
        whole.t_s[whole.tick_index], np.concatenate([r.t_s for r in coupled]), atol=1e-6
    )
    assert [s.u for s in whole.states] == whole.hysteresis_input_K[whole.tick_index].tolist()
    assert np.all(np.diff(whole.t_s) > 0)


def test_positions_alone_are_read_at_the_same_times_from_the_same_memories(joined_timeline):
    whole = predict(joined_timeline, twin_plant_model()[0])
    positions_only, kinds = whole.positions_only, joined_timeline.positions_only.all_readings
    assert [r.kind for r in kinds] == ["settled", "moving"] == list(positions_only.values)
    times = np.concatenate([r.t_s for r in kinds])
    np.testing.assert_allclose(positions_only.t_s[positions_only.tick_index], times, atol=1e-6)
    assert (
        len(positions_only.states)
        == positions_only.output.size
        == positions_only.output_slope.size
        == times.size
    )
    again = predict(joined_timeline.positions_only, twin_plant_model()[0])
    np.testing.assert_allclose(
        again.stacked(joined_timeline.positions_only),
        positions_only.stacked(joined_timeline.positions_only),
        atol=1e-6,
    )


@pytest.mark.long("takes a second", cases=("walking=1",))
@pytest.mark.parametrize(
    "effect",
    [
        "walking=1",
        *(
            pytest.param(effect, marks=pytest.mark.long("takes three seconds"))
            for effect in ("settling=5", "accommodation", "creep")
        ),
    ],
)
def test_effects_restart_in_each_session(tmp_path, effect):
    """Twice the same commands leave twice the same trace, however far the first had come."""
    (tmp_path / "a").mkdir(), (tmp_path / "b").mkdir()
    runs = [
        *session_runs(tmp_path / "a", LISTED, noise=False),
        *session_runs(tmp_path / "b", LISTED, noise=False),
    ]
    timeline, plant_model = build_timeline(runs, TAU_S), twin_plant_model()[0]
    trace = predict(timeline, plant_model, effects_from_pairs([effect])).values["settled"]
    trace = trace - predict(timeline, plant_model).values["settled"]
    first, second = trace[timeline.zero == 0], trace[timeline.zero == 1]
    assert np.abs(first).max() > 0.01
    np.testing.assert_allclose(second, first, atol=1e-9)


def test_sessions_that_begin_in_different_states_are_refused(apart):
    other = [replace(run, meta=run.meta | {"initial": "anhysteretic"}) for run in apart[1]]
    with pytest.raises(DataError, match=r"different states \(anhysteretic, negative\)"):
        build_timeline([*apart[0], *other], TAU_S)


def test_a_session_without_its_first_run_begins_like_the_others(apart):
    assert apart[0][1].meta["initial"] == "continued"
    assert len(build_timeline([apart[0][1], *apart[1]], TAU_S).sessions) == 2


def test_clocks_that_overlap_within_one_session_are_refused(apart):
    late = with_columns(apart[0][1], t_s=apart[0][1]["t_s"] - 5.0)
    with pytest.raises(DataError, match="belong to one session, but their clocks overlap"):
        build_timeline([apart[0][0], late, *apart[1]], TAU_S)


@pytest.mark.parametrize("correlation_s", [30.0, 120.0, 300.0, 1800.0])
def test_no_ambient_fluctuation_lasts_from_one_session_to_the_next(joined_timeline, correlation_s):
    plant_model, _ = twin_plant_model()
    whole = predict(joined_timeline, plant_model)
    C = memory_covariance(*memory_slopes(plant_model.hysteresis, whole), correlation_s)
    first = whole.session == 0
    assert np.abs(C[np.ix_(first, ~first)]).max() < 1e-6 * C.max()
    assert np.abs(C[np.ix_(~first, ~first)] - np.diag(np.diag(C)[~first])).max() > 0.1 * C.max()


def refitted(runs, **changes):
    plant_model = replace(twin_plant_model()[0], per_count=twin_plant_model()[1], **changes)
    timeline = build_timeline(runs, TAU_S)
    return refit(timeline, predict(timeline, plant_model), plant_model)


def test_each_session_has_an_encoder_zero_of_its_own(apart):
    """Without a free zero for the second session, the likelihood would change by thousands of nats."""
    before = refitted([*apart[0], *apart[1]])
    after = refitted([*apart[0], *(with_shifted_zero(run, SHIFT_MM) for run in apart[1])])
    assert after.log_evidence == pytest.approx(before.log_evidence, abs=0.05)
    np.testing.assert_allclose(after.log_components, before.log_components, atol=0.02)
    np.testing.assert_allclose(after.posterior.table().values, before.posterior.table().values, atol=1e-3)
    inside = with_shifted_zero(apart[1][0], SHIFT_MM)  # one run of it only: no zero is free there
    assert refitted([*apart[0], inside, apart[1][1]]).log_evidence < before.log_evidence - 50


def test_the_densitys_zero_is_that_of_the_first_session(apart):
    before = refitted([*apart[0], *apart[1]]).posterior.table()
    after = refitted([*(with_shifted_zero(run, SHIFT_MM) for run in apart[0]), *apart[1]]).posterior.table()
    np.testing.assert_allclose(after.values, before.values + SHIFT_MM, atol=2e-3)


def test_a_warmer_ambient_in_the_next_session_is_no_misfit(apart):
    """A thermometer shares no zero with a wire that starts again."""
    warm = [with_columns(run, ambient_degC=run["ambient_degC"] + 3.0) for run in apart[1]]
    before, after = refitted([*apart[0], *apart[1]]), refitted([*apart[0], *warm])
    assert after.log_evidence == pytest.approx(before.log_evidence, abs=5.0)


def test_a_channel_that_only_a_later_session_has_keeps_its_place(apart):
    """Readings that follow the output stand before all others, as the refit stacks them."""
    mute = [with_columns(run, voltage_V=np.full(len(run), np.nan)) for run in apart[0]]
    timeline = build_timeline([*mute, *apart[1]], TAU_S)
    assert [r.kind for r in timeline.all_readings] == ["settled", "moving", "resistance", "current", "room"]
