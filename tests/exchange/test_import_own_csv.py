"""smarig's own CSV format: required columns, errors, and steps found from the current."""

import numpy as np
import pytest

from smarig.core.errors import DataError, StorageError, UsageError
from smarig.exchange import import_file
from smarig.exchange.runs.hold_steps import Recording, found_steps, holds, tolerance
from smarig.plant.actuator import Actuator

COUNT_MM = 0.047


def _csv(columns):
    names = list(columns)
    rows = zip(*(np.asarray(columns[n]).tolist() for n in names))
    return ",".join(names) + "\n" + "\n".join(",".join(repr(x) for x in row) for row in rows) + "\n"


def _staircase(currents, hold_s=60.0, period_s=0.5):
    """First-order wire: each hold ends at 10 × current, time constant 4 s."""
    per = round(hold_s / period_s)
    current = np.repeat(currents, per)
    t_s = np.arange(current.size) * period_s
    position, y = np.empty(current.size), 10 * currents[0]
    for k, i in enumerate(current):
        y += (10 * i - y) * (1 - np.exp(-period_s / 4.0))
        position[k] = y
    return t_s, current, position


def test_a_correct_file_becomes_a_run(write, imported, small_csv):
    run = imported(write(small_csv))
    assert len(run) == 60
    assert run.meta["source"] == "import"
    assert run.meta["input"] == {"quantity": "current", "unit": "A"}
    assert run.unit == "mm"
    assert run.meta["imported"]["file"] == "data.csv"
    np.testing.assert_array_equal(run["input"], run["current_command_A"])


def test_order_of_columns_does_not_matter(write, imported, small_csv):
    rows = [line.split(",")[::-1] for line in small_csv.splitlines()]
    turned = imported(write("\n".join(",".join(r) for r in rows), "turned.csv"))
    straight = imported(write(small_csv))
    for name in ("t_s", "position", "current_command_A", "input"):
        np.testing.assert_array_equal(turned[name], straight[name])


def test_steps_are_found_and_averaged_over_the_last_25_s(write, imported):
    currents = [0.0, 0.3, 0.6, 0.2]
    t_s, current, position = _staircase(currents)
    run = imported(write(_csv({"time_s": t_s, "current_command_A": current, "position_mm": position})))
    assert [s.target for s in run.steps] == pytest.approx(currents)
    assert [s.branch for s in run.steps] == ["up", "up", "up", "down"]
    assert [s.n for s in run.steps] == [50] * 4
    for k, step in enumerate(run.steps):
        window = (t_s >= 60 * (k + 1) - 25) & (t_s < 60 * (k + 1))
        assert step.position == pytest.approx(position[window].mean(), abs=1e-12)
    assert run["step"].tolist() == np.repeat(np.arange(4.0), 120).tolist()
    assert any("last 25 s" in w for w in run.meta["warnings"])


def test_with_a_rig_the_target_is_its_wires_temperature(write, imported):
    t_s, current, position = _staircase([0.0, 0.4, 0.8])
    path = write(_csv({"time_s": t_s, "current_A": current, "position_mm": position}))
    run = imported(path, rig="one_wire_twin")
    wire = Actuator.named("gorbet_one_wire")
    assert [s.target for s in run.steps] == pytest.approx([wire.input_for(i) for i in (0.0, 0.4, 0.8)])
    assert run.input_unit == "K"
    assert run.meta["actuator"] == "gorbet_one_wire"
    hold_end = run["input"][run["step"] == 2][-1]
    assert hold_end == pytest.approx(wire.input_for(0.8), rel=1e-3)
    first = run["input"][run["step"] == 1][0]
    assert first == pytest.approx(wire.input_for(0.4) * (1 - np.exp(-0.5 / wire.tau_s)), rel=1e-9)


def test_in_the_differential_rig_the_targets_carry_the_sign(write, imported):
    t_s, current, position = _staircase([0.5, -0.5])
    path = write(_csv({"time_s": t_s, "current_A": current, "position_deg": position}))
    run = imported(path, rig="two_wire_twin")
    up, down = (s.target for s in run.steps)
    assert up == -down > 0
    assert run.unit == "deg"


def test_a_step_settles_when_its_last_25_s_stay_within_one_count(write, imported):
    t_s, current, position = _staircase([0.0, 0.5, 0.9])
    position = np.where(t_s >= 120, position + 0.02 * (t_s - 120), position)  # the last hold creeps
    path = write(_csv({"time_s": t_s, "current_A": current, "position_mm": position}))
    assert [s.verdict for s in imported(path, rig="one_wire_twin").steps] == ["settled", "settled", "elapsed"]


def test_holds_shorter_than_25_s_use_their_last_quarter_and_do_not_settle(write, imported):
    t_s, current, position = _staircase([0.0, 0.5], hold_s=20.0)
    path = write(_csv({"time_s": t_s, "current_A": current, "position_mm": position}))
    run = imported(path, rig="one_wire_twin")
    assert [s.n for s in run.steps] == [10, 10]
    assert {s.verdict for s in run.steps} == {"elapsed"}
    assert any("last quarter" in w for w in run.meta["warnings"])


@pytest.mark.parametrize(("slope_mm_per_s", "verdict"), [(0.0, "settled"), (0.005, "elapsed")])
def test_noise_of_single_rows_is_no_motion(slope_mm_per_s, verdict):
    """A row each second, and noise of half a count."""
    rng = np.random.default_rng(1)
    t_s = np.arange(60.0)
    position = 5.0 + slope_mm_per_s * t_s + 0.5 * COUNT_MM * rng.standard_normal(60)
    rows, _, _ = found_steps(Recording(t_s, position, COUNT_MM), [(0, 60)], lambda _a, _b: 1.0)
    assert rows[0][7] == verdict


def test_a_noisy_measured_current_gives_the_same_steps():
    rng = np.random.default_rng(1)
    clean = np.repeat([0.0, 0.02, 0.05, 0.03], 200)
    noisy = clean + rng.normal(0, 3e-4, clean.size)
    assert holds(noisy, tolerance(noisy)) == [(0, 200), (200, 400), (400, 600), (600, 800)]


def test_a_ramp_has_no_steps_and_is_reported(write, imported):
    t_s = np.arange(100) / 10
    run = imported(write(_csv({"time_s": t_s, "current_A": t_s / 10, "position_mm": t_s})))
    assert run.steps == ()
    assert any("No step was found" in w for w in run.meta["warnings"])


def test_given_steps_are_kept(write, imported, small_csv):
    lines = small_csv.splitlines()
    text = [lines[0] + ",step,flags"] + [f"{x},{k // 20},{4 * (k == 7)}" for k, x in enumerate(lines[1:])]
    run = imported(write("\n".join(text)))
    assert [s.index for s in run.steps] == [0, 1, 2]
    assert run["quality"].nonzero()[0].tolist() == [7]


def test_counts_need_the_rigs_factor(write, imported, small_csv):
    path = write(small_csv.replace("position_mm", "position_counts"))
    with pytest.raises(UsageError, match=r"encoder counts\. Name the rig"):
        imported(path)
    run = imported(path, rig="one_wire_twin")
    per_count = 2 * np.pi * 15.0 / 2000  # pulley of 15 mm radius, 2000 counts a turn
    np.testing.assert_allclose(run["position"], per_count * run["counts"], atol=per_count)
    assert run.meta["output"]["per_count"] == pytest.approx(per_count)


def test_a_rig_of_another_unit_is_refused(write, imported, small_csv):
    with pytest.raises(UsageError, match="has 'position_mm', but rig two_wire_twin measures deg"):
        imported(write(small_csv), rig="two_wire_twin")


def test_t0_moves_the_whole_run_on_the_shared_clock(write, imported, small_csv):
    plain, moved = imported(write(small_csv)), imported(write(small_csv), t0=3600.0, wire="W7")
    np.testing.assert_allclose(moved["t_s"] - plain["t_s"], 3600.0)
    assert moved.steps[1].t_start_s - plain.steps[1].t_start_s == 3600.0
    assert moved.meta["wire"] == "W7"


HEAD = "time_s,current_A,position_mm"


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("current_A,position_mm\n0,1\n1,2\n", "no column 'time_s'"),
        ("time_s,position_mm\n0,1\n1,2\n", "'current_command_A' or 'current_A' is needed"),
        ("time_s,current_A\n0,1\n1,2\n", "has no position; exactly one of"),
        (f"{HEAD},position_deg\n0,1,2,3\n1,2,3,4\n", "position_mm and position_deg; exactly one"),
        (f"{HEAD},humidity\n0,1,2,3\n1,2,3,4\n", "column 'humidity' is not one of time_s"),
        (f"{HEAD},counts\n0,1,2,3\n1,2,3,4\n", "column 'counts' is not one of"),
        (f"{HEAD}\n0,0,1\n2,0,1\n1,0,1\n", "line 4: 'time_s' goes back from 2 s to 1 s"),
        (f"{HEAD}\n0,0,1\n1,0,1\n1,0,1\n", r"line 4: 'time_s' repeats 1 s \(1 repeats in all\)"),
        (f"{HEAD}\n0,0,1\nnan,0,1\n1,0,1\n", "line 3: 'time_s' is empty or NaN"),
        (f"{HEAD}\n0,0,1\n1,nan,1\n2,0,1\n", "line 3: the current is empty or NaN"),
        (f"{HEAD}\n0,0,nan\n1,0,nan\n2,0,nan\n", "'position_mm' holds no number"),
        (f"{HEAD}\n0,0,1\n", "At least two"),
        (f"{HEAD}\n0,0,1\n1,450,1\n", "line 3, column 'current_A': 450 A .* Is the unit right"),
        (f"{HEAD},flags\n0,0,1,0\n1,0,1,0.5\n", "line 3, column 'flags': 0.5 is not a whole number"),
    ],
)
def test_what_breaks_the_contract_is_refused_naming_the_place(write, imported, text, said):
    with pytest.raises(DataError, match=said):
        imported(write(text))


def test_an_existing_run_is_kept_unless_forced(write, tmp_path, small_csv):
    path, out = write(small_csv), tmp_path / "kept.run.sqlite"
    out.write_text("precious")
    with pytest.raises(UsageError, match="exists; give another name or --force"):
        import_file(path, format="csv", out=out)
    assert out.read_text() == "precious"
    import_file(path, format="csv", out=out, force=True)
    assert out.read_bytes().startswith(b"SQLite format 3")


def test_a_refused_file_leaves_nothing_behind(write, tmp_path):
    path = write(f"{HEAD}\n0,0,1\n")
    with pytest.raises(DataError):
        import_file(path, format="csv", out=tmp_path / "none.run.sqlite")
    assert [p.name for p in tmp_path.iterdir()] == ["data.csv"]


def test_an_unwritable_run_is_reported(write, tmp_path, small_csv):
    (tmp_path / "file").write_text("not a folder")
    with pytest.raises(StorageError, match="cannot be written|cannot be created"):
        import_file(write(small_csv), format="csv", out=tmp_path / "file" / "x.run.sqlite")


def test_an_unknown_format_is_refused_with_the_known_ones(write, tmp_path, small_csv):
    with pytest.raises(UsageError, match="'ods'.*csv, forc"):
        import_file(write(small_csv), format="ods", out=tmp_path / "x")
