"""FOD data are found by following the memory, for any protocol."""

import numpy as np
import pytest

from identification.made_runs import PARTITION, driven_run, fod_inputs, fod_run, made_run
from smarig.core.errors import DataError, UsageError
from smarig.identification.fod_data import fod_data, select
from smarig.preisach.hysteresis.gorbet_1997 import thesis_surface


def points(data):
    return list(zip(data.alpha.tolist(), data.beta.tolist(), data.curve.tolist()))


@pytest.mark.parametrize(("name", "n"), [("one_e", 10), ("two_c", 11)])
def test_the_thesis_protocol_gives_n_n_plus_3_over_2_points(name, n):
    data = fod_data(fod_run(name))
    assert len(data) == n * (n + 3) // 2
    assert data.curves == n
    assert data.curve.max() == n - 1
    assert np.allclose(data.y, thesis_surface(name).y(data.alpha, data.beta), atol=1e-12)
    top = max(PARTITION[name[:3]])
    assert (data.major == ((data.alpha == data.beta) | (data.alpha == top))).all()


def test_minor_loops_are_left_out_until_they_are_wiped_out():
    inputs = [0, 30, 100, 60, 80, 70, 50, 0, 40, 20, 60, 0]
    data = fod_data(driven_run("one_e", inputs))
    assert points(data) == [
        *[(30, 30, 0), (100, 100, 0), (100, 60, 0)],  # 80 and 70 lie on a minor loop
        *[(100, 50, 0), (100, 0, 0)],  # 50 < 60 has wiped it out
        *[(40, 40, 1), (40, 20, 1)],
        *[(60, 60, 2), (60, 0, 2)],  # past 40 the rise is on the major branch again
    ]
    assert np.allclose(data.y, thesis_surface("one_e").y(data.alpha, data.beta), atol=1e-12)


def test_ascending_curves_come_in_the_mirror():
    levels = PARTITION["two"]
    inputs = [-u for u in fod_inputs([-v for v in reversed(levels)])]
    run = driven_run("two_e", inputs, initial="anhysteretic")
    data = fod_data(run)
    assert data.mirrored
    assert data.curves == 11
    # y(positive saturation → β → α) = y₊ − F(u₊, β) + F(α, β), an independent expression of the same output
    s = thesis_surface("two_e")
    falls = [s.everett(185.0, -a) for a in data.alpha]
    rises = [s.everett(-b, -a) for a, b in zip(data.alpha, data.beta)]
    assert np.allclose(data.y, -(s.y_upper - np.array(falls) + np.array(rises)), atol=1e-9)


def test_an_unknown_start_counts_from_the_first_saturation_on():
    inputs = [60, 100, 20, 0, 50, 30, 0, 100, 40, 0]
    run = driven_run("one_e", inputs)
    known, unknown = fod_data(run), fod_data(made_run(inputs, run.points()[1], initial=None))
    assert points(known)[:3] == [(60, 60, 0), (100, 100, 0), (100, 20, 0)]
    # (100, …) is the largest input, so it is positive saturation and the descent from it is known as well
    assert points(unknown)[0] == (100, 100, 0)


def test_an_anhysteretic_start_needs_a_full_swing():
    asymmetric = driven_run("two_e", [-100, 50, -100, 185, -100], initial="anhysteretic")
    with pytest.raises(DataError, match="only one curve|no first-order"):
        fod_data(asymmetric)


def test_several_runs_are_one_set_with_curves_numbered_on():
    a = driven_run("one_e", [0, 50, 20, 0, 174.1, 50, 0])
    b = driven_run("one_e", [0, 100, 50, 0])
    data = fod_data([a, b])
    assert data.curves == 3
    assert sorted(set(data.curve.tolist())) == [0, 1, 2]
    assert data.run.tolist() == [0] * 6 + [1] * 3


def test_a_run_that_continues_another_inherits_its_memory():
    meta = {"start_epoch": 5.0}
    a = driven_run("one_e", [0, 100, 40], **meta)
    whole = driven_run("one_e", [0, 100, 40, 20, 60, 120, 60], **meta)
    b = made_run([20, 60, 120, 60], whole.points()[1][3:], initial="continued", **meta)
    b.columns["t_s"] += a["t_s"][-1] + 1.0
    data = fod_data([a, b])
    assert points(data)[1:3] == [(100, 40, 0), (100, 20, 0)]
    assert 60.0 not in [beta for alpha, beta, _ in points(data) if alpha == 100]
    assert points(data)[-2:] == [(120, 120, 1), (120, 60, 1)]


@pytest.mark.parametrize(
    ("inputs", "words"),
    [
        ([0, 20, 60, 100], "no first-order descending curves"),
        ([0, 50, 100, 60, 30, 0], "only one curve"),
    ],
)
def test_too_little_is_refused_with_what_is_needed(inputs, words):
    with pytest.raises(DataError, match=words) as refused:
        fod_data(driven_run("one_e", inputs))
    assert "made.run.sqlite" in str(refused.value)


def test_runs_of_two_units_are_refused():
    with pytest.raises(DataError, match="different units"):
        fod_data([fod_run("one_e"), fod_run("two_e")])
    with pytest.raises(UsageError, match="No run"):
        fod_data([])


def test_table_of_a_regular_partition_and_the_first_missing_cell():
    data = fod_data(fod_run("one_p"))
    alpha, beta, y = data.as_table()
    assert alpha.tolist() == list(PARTITION["one"][1:])
    assert beta.tolist() == list(PARTITION["one"])
    below = beta <= alpha[:, None]
    assert np.allclose(
        y[below], thesis_surface("one_p").y(*np.broadcast_arrays(alpha[:, None], beta))[below], atol=1e-12
    )
    assert np.isnan(y[~below]).all()
    hole = data.where((data.alpha != 62.7) | (data.beta != 15.7))
    with pytest.raises(DataError, match=r"α = 62\.7, β = 15\.7"):
        hole.as_table()


def test_selecting_curves():
    data = fod_data(fod_run("one_e"))
    even, odd = select(data, "curve%2==0"), select(data, "curve%2==1")
    assert len(even) + len(odd) == len(data)
    assert set(even.alpha.tolist()) == {1.7, 15.7, 43.5, 85.3, 141.0}
    assert (even.lower, even.upper) == (0.0, 174.1)
    with pytest.raises(UsageError, match="curves 0 to 9"):
        select(data, "curve > 40")


def test_reversal_curves_come_numbered_by_step_without_calibration():
    fields = np.array([5, 0, 2, 5, 5, -3, 0, 2, 5], dtype=float)
    run = made_run(fields, 2 * fields, unit="emu", initial=None, protocol="first_order_reversal_curves")
    run = type(run)(
        run.path, run.meta, run.columns | {"step": np.array([-1, 0, 0, 0, -1, 1, 1, 1, 1.0])}, (), ()
    )
    data = fod_data(run)
    assert data.mirrored
    assert points(data) == [(0, 0, 0), (0, -2, 0), (0, -5, 0), (3, 3, 1), (3, 0, 1), (3, -2, 1), (3, -5, 1)]
    assert data.point.tolist() == [1, 2, 3, 5, 6, 7, 8]
    assert data.y.tolist() == [0, -4, -10, 6, 0, -4, -10]
