"""Injected faults in a file are reported; a correct file gives no warnings."""

import re

import numpy as np
import pytest

from smarig.exchange.checks.channel_faults import channel_findings, clipped, quantum, unused_findings
from smarig.exchange.checks.findings import duplicate_columns, repeated_rows, saturation_marks
from smarig.exchange.checks.loop_faults import LoopRecord, branch_ends, loop_findings
from smarig.exchange.checks.time_axis import time_findings

N = 400
LINE = np.arange(2, N + 2)
UP = np.linspace(0, 100, N // 2)
U = np.concatenate([UP, UP[::-1]])


def _wire(u):
    """A loop with lag: rises around 60, falls around 40."""
    rising = np.arange(u.size) < u.size // 2
    return 1 / (1 + np.exp(-(u - np.where(rising, 60, 40)) / 5))


def _texts(findings):
    return [f.text for f in findings]


def _kinds(findings):
    return [f.kind for f in findings if f.kind]


def _channel(x):
    return _texts(channel_findings("temperature_degC", "degC", x, LINE))


def _loop(u, y):
    return _texts(loop_findings(LoopRecord(u, y, LINE, "degC", "mm")))


def _healthy():
    return _wire(U) + np.random.default_rng(3).normal(0, 1e-4, N)


def test_a_correct_record_gives_no_warning():
    assert _channel(_healthy()) == []
    assert _loop(U, _healthy()) == []
    assert time_findings(np.arange(N) * 0.1, LINE, "refuse") == []


def test_a_clipped_sensor_is_found_where_it_is_clipped():
    x = _healthy()
    top = np.quantile(x, 0.9)
    stuck = np.minimum(x, top)
    np.testing.assert_array_equal(clipped(stuck), stuck == top)
    assert "clipped at" in _channel(stuck)[0]
    marks = saturation_marks(
        {"temperature_degC": stuck, "input": stuck}, {"temperature_degC": "degC", "input": ""}
    )
    np.testing.assert_array_equal(marks, np.where(stuck == top, 4, 0))


def test_a_resting_or_coarse_channel_is_not_clipped():
    assert not clipped(np.round(_wire(U) * 50)).any()
    assert not clipped(np.repeat(np.arange(10.0), 40)).any()


@pytest.mark.parametrize("step", [0.085, 0.25, 3.0])
def test_coarse_steps_are_measured(step):
    x = np.round(_healthy() * 60) * step
    assert quantum(x) == pytest.approx(step, rel=1e-3)
    assert any(f"comes in steps of {step:g} degC" in s for s in _channel(x))
    assert quantum(_healthy()) is None


def test_spikes_a_dead_channel_and_held_values():
    x = 20 + _healthy()
    x[100] = 1000.0
    assert any(
        "single-row spikes in 1 place(s), the largest 1000 degC" in s and "line 102" in s for s in _channel(x)
    )
    assert _channel(np.full(N, 7.0)) == [
        "temperature_degC is 7 degC in every row. It is nominal or not connected, not measured."
    ]
    assert any(
        "changes only every 20 rows" in s
        for s in _channel(np.repeat(np.random.default_rng(1).random(20), 20))
    )


def test_an_unsampled_jump_is_found_with_its_lines():
    y = np.where(np.arange(N) < 120, 0.0, 5.0)
    assert any("at most +5 mm from line 121 to 122" in s for s in _loop(U, y))


@pytest.mark.parametrize("height", [0.15, -0.5, 3.0])
@pytest.mark.parametrize("noise", [0.0, 0.3])
def test_a_row_alone_is_no_jump(height, noise):
    y = _healthy()
    y[[30, 250]] += height
    u = U + np.random.default_rng(6).normal(0, noise, N)
    assert not any("jumps" in s for s in _loop(u, y))
    y[100:] += 2 * abs(height)
    assert any("in 1 place(s)" in s and "from line 101 to 102" in s for s in _loop(u, y))


def test_a_row_alone_on_a_steep_branch_is_no_jump():
    y = np.interp(U, [50, 65], [0.0, 1.0])  # 30 rows, of which one lies 8 % above its branch
    y[107] += 0.08
    assert np.abs(np.diff(y)).max() > 0.1
    assert not any("jumps" in s for s in _loop(U, y))


def test_an_output_that_follows_a_coarse_input_jumps():
    u = np.tile([0.0, 100.0, 0.0, 40.0], 6)
    found = _texts(loop_findings(LoopRecord(u, u / 100, np.arange(24), "degC", "mm")))
    assert any("jumps" in s for s in found)


def test_rows_left_out_are_no_jump():
    y = _healthy()
    y[100:140] = np.nan  # the steep part
    assert not any("jumps" in s for s in _loop(U, y))


def test_noise_in_the_input_is_counted():
    noisy = U + np.random.default_rng(2).normal(0, 4, N)
    assert any("direction of its branch" in s for s in _loop(noisy, _healthy()))


@pytest.mark.parametrize(("pulled", "force"), [("mm", "N"), ("%", "MPa")])
def test_a_force_leads_an_elongation_as_work_is_lost(pulled, force):
    y = _wire(U)[::-1]
    loop = LoopRecord(U, y, np.arange(N), pulled, force)
    (found,) = [f.text for f in loop_findings(loop) if f.kind == "leading output"]
    assert "take the force as the input" in found
    assert "swapped" not in found


def test_swapped_branches_run_the_wrong_way_round():
    y = _wire(U)[::-1]
    assert any("output leads its input" in s for s in _loop(U, y))
    assert any("output leads its input" in s for s in _loop(U, -y))
    assert not any("output leads its input" in s for s in _loop(U, -_wire(U)))


def test_a_loop_that_does_not_close_is_reported_with_its_gap():
    y = _healthy() + np.linspace(0, 0.1, N)
    found = [s for s in _loop(U, y) if "does not close" in s]
    assert len(found) == 1
    assert "At the low end" in found[0]
    assert re.search(r"→ 0\.100\d mm over 2 visits \(\+9\.\d %", found[0])


def _relays(u, seed=0, shift=0.0):
    """A sum of relays between 0 and 100 that begin down; ``shift`` adds up from branch to branch."""
    rng = np.random.default_rng(seed)
    low, high = np.sort(rng.uniform(0, 100, (2, 500)), axis=0)
    up, y = np.zeros(500, dtype=bool), []
    for v in u:
        up = (up | (v >= high)) & ~(v <= low)
        y.append(np.mean(up))
    return np.array(y) + shift * np.arange(u.size) / u.size


def _way(*turns, rows=60):
    legs = [np.linspace(a, b, rows, endpoint=False) for a, b in zip(turns, turns[1:])]
    return np.concatenate([*legs, [turns[-1]]])


def _open_loops(u, y):
    return [s for s in _loop_of(u, y) if "does not close" in s]


def _loop_of(u, y):
    return _texts(loop_findings(LoopRecord(u, y, np.arange(u.size), "kA/m", "")))


@pytest.mark.parametrize(
    "turns",
    [
        (0, 100, 0, 100, 10, 96, 4, 97, 3, 95.5, 30),  # near the ends, but not at them
        (50, 100, 0, 80, 50),  # first and last row at one input, in two states
        (0, 96, 2, 100, 0, 97, 4),
        (100, 3, 98, 0, 100, 1, 96),
    ],
)
@pytest.mark.parametrize("noise", [0.0, 0.1])
def test_turns_in_other_states_of_a_hysteresis_are_no_open_loop(turns, noise):
    u = _way(*turns)
    measured = u + np.random.default_rng(7).normal(0, noise, u.size)
    assert _open_loops(measured, _relays(u, seed=len(turns))) == []


@pytest.mark.parametrize("noise", [0.0, 0.3])
def test_the_same_end_reached_again_with_another_output_is_an_open_loop(noise):
    u = _way(0, 100, 0, 96, 10, 100, 0, 100, 2)
    u_read = u + np.random.default_rng(8).normal(0, noise, u.size)
    found = _open_loops(u_read, _relays(u, shift=0.2))
    assert [s.split(" the output")[0] for s in found] == [
        "At the low end of the input",
        "At the high end of the input",
    ]
    assert "over 3 visits" in found[0]


@pytest.mark.parametrize("seed", range(4))
def test_noise_at_the_ends_is_no_open_loop(seed):
    u = _way(0, 100, 0, 100, 0, 100, 0)
    noise = np.random.default_rng(seed).normal(0, 0.02, u.size)
    assert _open_loops(u, _relays(u) + noise) == []
    assert len(_open_loops(u, _relays(u, shift=0.4) + noise)) == 2


def test_an_offset_of_a_symmetric_drive_is_found_but_not_of_a_temperature():
    volts = LoopRecord(U - 40, _healthy(), LINE, "V", "uC/cm^2")
    assert any("centre +10" in s for s in _texts(loop_findings(volts)))
    assert not any("centre" in s for s in _loop(U - 40, _healthy()))


def test_copies_and_repeats():
    a = np.random.default_rng(4).random(N)
    assert "identical" in duplicate_columns({"a": a, "b": a.copy()})[0]
    assert "+0.248: the same data with another zero" in duplicate_columns({"a": a, "b": a + 0.248})[0]
    assert duplicate_columns({"a": a, "b": a**2}) == []
    twice = np.repeat(a[:10], 2)
    assert "10 rows repeat the row before" in repeated_rows({"a": twice}, LINE[:20])[0].text


def test_clocks_of_tables_side_by_side_are_no_copies():
    t, force = np.arange(50) * 0.1, np.sin(np.arange(50) / 5)
    assert duplicate_columns({"Zeit": t, "Zeit (2)": t.copy(), "Zeit (3)": t + 2.0}) == []
    assert "identical" in duplicate_columns({"Kraft": force, "Kraft (2)": force.copy()})[0]
    assert "identical" in duplicate_columns({"Zeit": t, "Weg (2)": t.copy()})[0]


def test_time_gaps_are_found():
    t_s = np.arange(N) * 0.1
    t_s[200:] += 30
    assert "1 time gaps" in time_findings(t_s, LINE, "refuse")[0].text
    assert "30.1 s after line 201" in time_findings(t_s, LINE, "refuse")[0].text


def test_what_a_study_or_a_diagnosis_asks_for_has_a_kind_beside_its_sentence():
    healthy = _healthy()

    def of(u, y):
        return _kinds(loop_findings(LoopRecord(u, y, LINE, "degC", "mm")))

    def of_channel(x):
        return _kinds(channel_findings("temperature_degC", "degC", x, LINE))

    assert of(U, np.where(np.arange(N) < 120, 0.0, 5.0)) == ["jump", "open loop"]
    assert of(U + np.random.default_rng(2).normal(0, 4, N), healthy) == ["noisy input"]
    assert of(U, _wire(U)[::-1]) == ["leading output"]
    assert of(np.where(np.isin(np.arange(N), [150, 151]), 0.0, U), healthy) == ["drop-outs"]
    assert of_channel(np.minimum(healthy, np.quantile(healthy, 0.9))) == ["clipped channel"]
    assert of_channel(np.where(np.arange(N) == 100, 1000.0, healthy)) == ["spikes"]
    assert _kinds(unused_findings("The column", np.where(np.arange(N) == 100, 1000.0, healthy), LINE)) == []
    assert _kinds(time_findings(np.repeat(np.arange(N / 2), 2), LINE, "mean")) == ["repeated times"]


def test_branch_ends_ignore_what_is_smaller_than_the_threshold():
    rng = np.random.default_rng(5)
    u = np.concatenate([np.linspace(0, 10, 200), np.linspace(10, 2, 200), np.linspace(2, 9, 200)])
    turns = branch_ends(u + rng.normal(0, 0.1, u.size), 2.0)
    assert len(turns) == 4
    np.testing.assert_allclose(turns, [0, 200, 400, 599], atol=10)


def test_a_designed_sequence_is_checked_for_loop_direction_only():
    u = np.concatenate([U, [0, 100, 50, 70, 20, 90, 0]])
    y = np.concatenate([_healthy(), [0.5, 1, 1, 1, 0.2, 0.9, 0.3]])
    loop = LoopRecord(u, y, np.arange(u.size), "K", "mm")
    assert len(loop_findings(loop)) > 0
    assert loop_findings(loop, designed=True) == []
    backwards = LoopRecord(U, _healthy()[::-1], LINE, "K", "mm")
    assert "output leads its input" in loop_findings(backwards, designed=True)[0].text


def _growing_cycles(rows):
    """The input of a test whose cycles grow, from 8 % of its range on, with so many rows a half cycle."""
    peaks = [0.0, 4, -4, 6, -6, 9, -9, 50, -50, 0]
    return np.concatenate([np.linspace(a, b, rows + 1)[1:] for a, b in zip(peaks, peaks[1:])])


def _noise_findings(u):
    line = np.arange(2, u.size + 2)
    return [f for f in loop_findings(LoopRecord(u, u, line, "mm", "kN")) if f.kind == "noisy input"]


def test_small_cycles_are_no_noise_but_single_rows_are():
    assert _noise_findings(_growing_cycles(4)) == []
    noisy = _growing_cycles(40)
    noisy[5::10] += 8.0
    (found,) = _noise_findings(noisy)
    assert "(small cycles not counted)" in found.text


def test_a_single_row_of_a_short_record_is_no_noise():
    assert _noise_findings(np.array([5.0, 4.0, *np.linspace(4.5, 50, 20), *np.linspace(48, 0, 20)])) == []
