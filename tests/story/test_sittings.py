"""Several sittings as one story: each is lived anew, on its own clock and from its own zero."""

from dataclasses import replace

import numpy as np
import pytest

from smarig.diagnosis.noise import propagated, remembered
from smarig.diagnosis.refit import refit
from smarig.errors import DataError
from smarig.model.planted import from_pairs
from smarig.story.retelling import COUPLED, retold
from smarig.story.told import told
from story.sittings import LISTED, LONG, believed, sitting

TAU_S = 5.3
FEW = ("step_currents", {"temperatures_K": (0.0, 75.0, 30.0, 95.0, 20.0)})
SHIFT_MM = 1.0


@pytest.fixture(scope="module")
def apart(tmp_path_factory):
    """The runs of two sittings; the second is longer."""
    return [
        sitting(tmp_path_factory.mktemp("sittings"), *protocols, seed=seed)
        for seed, protocols in enumerate([(LISTED, FEW), (LONG, LISTED)])
    ]


@pytest.fixture(scope="module")
def joined(apart):
    return told([run for runs in apart for run in runs], TAU_S)


def with_columns(run, **columns):
    return replace(run, columns=run.columns | columns)


def lifted(run, by):
    """The run with another zero of its encoder."""
    steps = tuple(replace(s, position=s.position + by) for s in run.steps)
    return replace(with_columns(run, position=run["position"] + by), steps=steps)


def test_a_joined_story_holds_every_sittings_readings_in_turn(apart, joined):
    alone = [told(runs, TAU_S) for runs in apart]
    assert len(joined.sittings) == 2
    assert joined.zero.tolist() == [0] * len(alone[0].settled) + [1] * len(alone[1].settled)
    assert joined.hours == max(story.hours for story in alone)
    for r in joined.kinds:
        own = [q for story in alone for q in story.kinds if q.kind == r.kind]
        assert r.value.tolist() == [v for q in own for v in q.value.tolist()]
        assert np.all(np.diff(r.t_s) > 0)
    for name in ("target_K", "hold_s"):
        assert getattr(joined, name).tolist() == [v for s in alone for v in getattr(s, name).tolist()]
    assert joined.run.tolist() == [k for k, run in enumerate(joined.runs) for _ in run.settled]
    assert not set(joined.block[joined.zero == 0]) & set(joined.block[joined.zero == 1])


def test_sittings_are_told_in_the_order_in_which_they_began(apart, joined):
    again = told([run for runs in apart[::-1] for run in runs], TAU_S)
    assert again.settled.value.tolist() == joined.settled.value.tolist()


def test_one_sitting_is_no_joined_story(apart):
    alone = told(apart[0], TAU_S)
    assert alone.sittings == ()
    assert alone.zero.size == 0


@pytest.mark.parametrize(
    "effects", [(), ("walking=1",), ("settling=5",), ("ambient_drift=2", "ambient_drift.period_h=0.3")]
)
def test_a_joined_story_is_retold_as_its_sittings_are(apart, joined, effects):
    subject, _ = believed(effects)
    whole = retold(joined, subject)
    alone = [(story, retold(story, subject)) for story in (told(runs, TAU_S) for runs in apart)]
    for r in joined.kinds:
        parts = [part.values[r.kind] for _, part in alone if r.kind in part.values]
        assert whole.values[r.kind].tolist() == np.concatenate(parts).tolist()
    order = [(story, part, kind) for kind in COUPLED for story, part in alone if kind in part.values]
    for name in ("output", "follows", "states"):
        parts = [list(getattr(part, name)[part.of(kind)]) for _, part, kind in order]
        assert list(getattr(whole, name)) == [v for part in parts for v in part]
    assert whole.sitting.tolist() == [
        k for kind in COUPLED for k, (_, part) in enumerate(alone) for _ in part.values.get(kind, ())
    ]


def test_a_retellings_marks_are_the_times_of_its_readings(joined):
    whole = retold(joined, believed()[0])
    coupled = [r for r in joined.kinds if r.kind in COUPLED]
    np.testing.assert_allclose(whole.t_s[whole.marks], np.concatenate([r.t_s for r in coupled]), atol=1e-6)
    assert [s.u for s in whole.states] == whole.felt_K[whole.marks].tolist()
    assert np.all(np.diff(whole.t_s) > 0)


def test_positions_alone_are_read_at_the_same_times_from_the_same_memories(joined):
    whole = retold(joined, believed()[0])
    placed, kinds = whole.placed, joined.placed.kinds
    assert [r.kind for r in kinds] == ["settled", "moving"] == list(placed.values)
    times = np.concatenate([r.t_s for r in kinds])
    np.testing.assert_allclose(placed.t_s[placed.marks], times, atol=1e-6)
    assert len(placed.states) == placed.output.size == placed.follows.size == times.size
    again = retold(joined.placed, believed()[0])
    np.testing.assert_allclose(again.stacked(joined.placed), placed.stacked(joined.placed), atol=1e-6)


@pytest.mark.parametrize("effect", ["walking=1", "settling=5", "accommodation", "creep"])
def test_effects_begin_anew_in_each_sitting(tmp_path, effect):
    """Twice the same commands leave twice the same trace, however far the first had come."""
    (tmp_path / "a").mkdir(), (tmp_path / "b").mkdir()
    runs = [*sitting(tmp_path / "a", LISTED, noise=False), *sitting(tmp_path / "b", LISTED, noise=False)]
    story, subject = told(runs, TAU_S), believed()[0]
    trace = retold(story, subject, from_pairs([effect])).values["settled"]
    trace = trace - retold(story, subject).values["settled"]
    first, second = trace[story.zero == 0], trace[story.zero == 1]
    assert np.abs(first).max() > 0.01
    np.testing.assert_allclose(second, first, atol=1e-9)


def test_sittings_that_begin_in_different_states_are_refused(apart):
    other = [replace(run, meta=run.meta | {"initial": "anhysteretic"}) for run in apart[1]]
    with pytest.raises(DataError, match=r"different states \(anhysteretic, negative\)"):
        told([*apart[0], *other], TAU_S)


def test_a_sitting_whose_first_run_is_not_given_begins_like_the_others(apart):
    assert apart[0][1].meta["initial"] == "continued"
    assert len(told([apart[0][1], *apart[1]], TAU_S).sittings) == 2


def test_clocks_that_overlap_within_one_sitting_are_refused(apart):
    late = with_columns(apart[0][1], t_s=apart[0][1]["t_s"] - 5.0)
    with pytest.raises(DataError, match="of one sitting, but their clocks overlap"):
        told([apart[0][0], late, *apart[1]], TAU_S)


@pytest.mark.parametrize("correlation_s", [30.0, 120.0, 300.0, 1800.0])
def test_no_draught_lasts_from_one_sitting_to_the_next(joined, correlation_s):
    subject, _ = believed()
    whole = retold(joined, subject)
    C = propagated(*remembered(subject.hysteresis, whole), correlation_s)
    first = whole.sitting == 0
    assert np.abs(C[np.ix_(first, ~first)]).max() < 1e-6 * C.max()
    assert np.abs(C[np.ix_(~first, ~first)] - np.diag(np.diag(C)[~first])).max() > 0.1 * C.max()


def refitted(runs, **changes):
    subject = replace(believed()[0], per_count=believed()[1], **changes)
    story = told(runs, TAU_S)
    return refit(story, retold(story, subject), subject)


def test_each_sitting_has_an_encoders_zero_of_its_own(apart):
    """What another zero of the second sitting would change, if it were not free: thousands of nats."""
    before = refitted([*apart[0], *apart[1]])
    after = refitted([*apart[0], *(lifted(run, SHIFT_MM) for run in apart[1])])
    assert after.log_evidence == pytest.approx(before.log_evidence, abs=0.05)
    np.testing.assert_allclose(after.spreads, before.spreads, atol=0.02)
    np.testing.assert_allclose(after.posterior.table().values, before.posterior.table().values, atol=1e-3)
    inside = lifted(apart[1][0], SHIFT_MM)  # one run of it only: no zero is free there
    assert refitted([*apart[0], inside, apart[1][1]]).log_evidence < before.log_evidence - 50


def test_the_densitys_zero_is_that_of_the_first_sitting(apart):
    before = refitted([*apart[0], *apart[1]]).posterior.table()
    after = refitted([*(lifted(run, SHIFT_MM) for run in apart[0]), *apart[1]]).posterior.table()
    np.testing.assert_allclose(after.values, before.values + SHIFT_MM, atol=2e-3)


def test_a_room_that_is_warmer_at_the_next_sitting_is_no_misfit(apart):
    """A thermometer has no zero in common with a wire that begins anew."""
    warm = [with_columns(run, ambient_degC=run["ambient_degC"] + 3.0) for run in apart[1]]
    before, after = refitted([*apart[0], *apart[1]]), refitted([*apart[0], *warm])
    assert after.log_evidence == pytest.approx(before.log_evidence, abs=5.0)


def test_a_channel_that_only_a_later_sitting_has_keeps_its_place(apart):
    """Readings that follow the output stand before all others, as the refit stacks them."""
    mute = [with_columns(run, voltage_V=np.full(len(run), np.nan)) for run in apart[0]]
    story = told([*mute, *apart[1]], TAU_S)
    assert [r.kind for r in story.kinds] == ["settled", "moving", "resistance", "current", "room"]
