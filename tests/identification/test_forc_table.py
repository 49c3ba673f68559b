"""A hysteresis from irregular first-order curves: exact at measured points, accurate between them.

The magnetic files are measurements by others (../shared/data/forc_magnetic). A minimal reader is included,
so that these tests do not depend on an importer.
"""

from pathlib import Path

import numpy as np
import pytest

from smarig.core.errors import DataError
from smarig.identification.forc.forc_curves import curves_from_run
from smarig.preisach.hysteresis.fod_table import FodTable
from smarig.preisach.hysteresis.forc_table import ForcCurve, ForcTable
from smarig.preisach.hysteresis.gorbet_1997 import THESIS_PARTITIONS, thesis_surface
from smarig.preisach.hysteresis.mirrored import Mirrored
from smarig.preisach.operator import Preisach
from smarig.record.run import Run
from smarig.record.schema import SAMPLE_COLUMNS

DATA = Path(__file__).resolve().parents[2] / ".." / "shared" / "data" / "forc_magnetic"
# The required figures for held-out interior curves, as shares of the measured output range.
REQUIRED = {"hchb_forc": 0.0006, "MSM33-55-1_d330.forc": 0.0005, "UB199BF": 0.00015}
ONE_C = thesis_surface("one_c")


def run_of(step, field, moment, protocol="first_order_reversal_curves") -> Run:
    columns = {name: np.full(len(step), np.nan) for name in SAMPLE_COLUMNS}
    columns |= {"tick": np.arange(len(step), dtype=float), "step": np.asarray(step, dtype=float)}
    columns |= {"input": np.asarray(field, dtype=float), "position": np.asarray(moment, dtype=float)}
    return Run(Path("curves.run.sqlite"), {"protocol": protocol}, columns, (), ())


def magnetic_run(name: str) -> Run:
    """Blocks of 'field,moment' lines; alternately one calibration point and one curve."""
    if not (DATA / name).is_file():
        pytest.skip(f"{DATA / name} is not there")
    blocks: list[list[list[float]]] = [[]]
    for line in (DATA / name).read_text(encoding="latin-1").splitlines():
        if line[:1] in ("+", "-"):
            blocks[-1].append([float(v) for v in line.split(",")])
        elif blocks[-1]:
            blocks.append([])
    blocks = [b for b in blocks if b]
    assert all(len(b) == 1 for b in blocks[::2])
    step = [-1 if k % 2 == 0 else k // 2 for k, b in enumerate(blocks) for _ in b]
    field, moment = np.array([row for b in blocks for row in b]).T
    return run_of(step, field, moment)


def irregular_curves(count: int = 25, seed: int = 1, trimmed: bool = False) -> list[ForcCurve]:
    """Noise-free curves of the thesis's one_c surface on jittered inputs, optionally cut before saturation."""
    random = np.random.default_rng(seed)
    curves = []
    for k in range(1, count + 1):
        alpha = ONE_C.upper * (k + random.uniform(-0.2, 0.2) * (k < count)) / count
        inner = np.sort(random.uniform(0.5, alpha, 3 * k))[::-1]
        last = [] if trimmed and k % 3 else [ONE_C.lower]
        beta = np.array([alpha, *inner[: inner.size - (k if last == [] else 0)], *last])
        y = np.array([float(ONE_C.y(alpha, b)) for b in beta])
        curves.append(ForcCurve(float(alpha), beta, y, (ONE_C.lower, ONE_C.y_lower)))
    return curves


# --- what was measured is met -----------------------------------------------------------------------------


def test_every_measured_point_is_met_exactly():
    curves = irregular_curves(trimmed=True)
    table = ForcTable.from_curves(curves)
    for curve in curves:
        assert np.array_equal(table.y(np.full_like(curve.beta, curve.alpha), curve.beta), curve.y)
        for beta, y in zip(curve.beta.tolist(), curve.y.tolist()):
            assert table.everett(curve.alpha, beta) == curve.y[0] - y


@pytest.mark.parametrize("name", REQUIRED)
def test_magnetic_curves_train_exactly_and_predict_the_held_out_ones(name):
    run = magnetic_run(name)
    curves = curves_from_run(run)
    table = ForcTable.from_curves(curves[::2])
    predicted = Preisach(Mirrored(table)).simulate(run["input"], initial="positive")
    range_ = np.ptp(run["position"])
    error = (predicted - run["position"]) / range_
    step = run["step"]
    trained = (step >= 0) & (step % 2 == 0)
    interior = (step % 2 == 1) & (step >= 1) & (step < len(curves) - 1)
    assert np.sum(interior) > 4000
    assert np.max(np.abs(error[trained])) < 1e-12
    assert np.sqrt(np.mean(error[interior] ** 2)) <= 0.7 * REQUIRED[name]
    calibration = step == -1
    assert np.max(np.abs(error[calibration])) < 0.01  # only the drift, which the table leaves as it is


def test_held_out_curves_of_a_known_surface_are_predicted():
    curves = irregular_curves(50)
    table = ForcTable.from_curves([*curves[::2], curves[-1]])
    operator = Preisach(table)
    errors = []
    for curve in curves[1:-1:2]:
        operator.reset("negative")
        operator.step(curve.alpha)
        errors += [operator.step(b) - y for b, y in zip(curve.beta.tolist(), curve.y.tolist())]
    assert np.sqrt(np.mean(np.square(errors))) < 0.003 * (ONE_C.y_upper - ONE_C.y_lower)


# --- the same thing as what is already trusted ---------------------------------------------------------------


@pytest.fixture(scope="module")
def twins():
    nodes = np.array(THESIS_PARTITIONS["one_wire"])
    values = np.where(np.tri(nodes.size, dtype=bool), ONE_C.y(nodes[:, None], nodes), np.nan)
    regular = FodTable.from_arrays(nodes, nodes, values)
    curves = [ForcCurve(float(nodes[i]), nodes[i::-1], values[i, i::-1]) for i in range(1, nodes.size)]
    return regular, ForcTable.from_curves(curves)


def test_on_one_partition_it_is_the_bilinear_table(twins):
    regular, table = twins
    random = np.random.default_rng(2)
    alpha = random.uniform(regular.lower, regular.upper, 3000)
    beta = regular.lower + random.uniform(0, 1, 3000) * (alpha - regular.lower)
    assert np.max(np.abs(table.y(alpha, beta) - regular.y(alpha, beta))) < 1e-12
    assert np.max(np.abs(table.strip_beta(alpha, beta) - regular.strip_beta(alpha, beta))) < 1e-12
    # Below the first peak the bilinear table draws the same straight line, so F agrees there too.
    assert np.max(np.abs(table.strip_alpha(alpha, beta) - regular.strip_alpha(alpha, beta))) < 1e-12
    walk = random.uniform(regular.lower, regular.upper, 2000)
    assert np.max(np.abs(Preisach(table).simulate(walk) - Preisach(regular).simulate(walk))) < 1e-11


@pytest.mark.parametrize("centre", [20.0, 43.5, 60.0, 100.0])
def test_diagonal_states_are_those_a_decaying_oscillation_leaves(centre):
    table = ForcTable.from_curves(irregular_curves(12))
    operator = Preisach(table)
    swings = np.linspace(table.upper, 0.0, 8001)
    walk = np.clip(centre + swings * np.where(np.arange(swings.size) % 2, -1, 1), table.lower, table.upper)
    after = operator.simulate(walk)[-1]
    assert operator.go_to_diagonal(centre) == pytest.approx(after, abs=2e-3)
    for u in (centre + 15.0, centre - 15.0):
        operator.simulate(walk)
        swept = operator.step(u)
        operator.go_to_diagonal(centre)
        assert operator.step(u) == pytest.approx(swept, abs=2e-3)


def test_slopes_are_those_of_the_surface():
    table = ForcTable.from_curves(irregular_curves(10, trimmed=True))
    random = np.random.default_rng(3)
    alpha = random.uniform(table.lower, table.upper, 400)
    beta = table.lower + random.uniform(0, 1, 400) * (alpha - table.lower)
    h = 1e-6
    clear = np.array([np.abs(table.kinks - v).min() for v in np.concatenate([alpha, beta])]) > 2 * h
    clear = clear[:400] & clear[400:] & (alpha - beta > 2 * h)
    assert clear.sum() > 300
    alpha, beta = alpha[clear], beta[clear]
    forces = [np.array([table.everett(a, b) for a, b in zip(alpha + d, beta)]) for d in (-h, h)]
    assert table.strip_alpha(alpha, beta) == pytest.approx((forces[1] - forces[0]) / (2 * h), abs=1e-6)
    slope = (table.y(alpha, beta + h) - table.y(alpha, beta - h)) / (2 * h)
    assert table.strip_beta(alpha, beta) == pytest.approx(slope, abs=1e-6)


def test_scalars_and_arrays_agree():
    table = ForcTable.from_curves(irregular_curves(9, trimmed=True))
    grid = np.linspace(table.lower, table.upper, 60)
    alpha, beta = (m[np.tri(60, dtype=bool)] for m in np.meshgrid(grid, grid, indexing="ij"))
    scalar = [table.everett(a, b) for a, b in zip(alpha.tolist(), beta.tolist())]
    assert np.max(np.abs(table.y(alpha, alpha) - table.y(alpha, beta) - scalar)) < 1e-13


# --- what was not measured -------------------------------------------------------------------------------------


def test_a_trimmed_curve_is_continued_from_its_neighbours_and_reported():
    whole, trimmed = (ForcTable.from_curves(irregular_curves(24, trimmed=t)) for t in (False, True))
    curve = next(c for c in trimmed.curves[12:] if c.beta[-1] > 0)
    beyond = np.linspace(0.5, curve.beta[-1] - 0.5, 50)
    peak = np.full_like(beyond, curve.alpha)
    straight = np.interp(beyond, [0.0, curve.beta[-1]], [0.0, curve.y[-1]])
    completed_curves, true = trimmed.y(peak, beyond), whole.y(peak, beyond)
    assert np.abs(completed_curves - true).max() < 0.25 * np.abs(straight - true).max()
    assert not trimmed.measured(peak, beyond).any()
    assert trimmed.measured(np.full_like(curve.beta, curve.alpha), curve.beta).all()
    assert whole.measured(peak, beyond).all()
    assert not whole.measured([1.0, 200.0, 50.0], [0.5, 10.0, 60.0]).any()


def test_no_memory_is_claimed_below_the_first_peak():
    table = ForcTable.from_curves(irregular_curves(8))
    first = table.curves[0]
    operator = Preisach(table)
    up = operator.simulate(np.linspace(0.0, 0.9 * first.alpha, 7))
    down = [operator.step(u) for u in np.linspace(0.9 * first.alpha, 0.0, 7)]
    assert np.allclose(up, down[::-1], atol=1e-14)


def test_a_curve_that_goes_beyond_the_calibration_points_sets_saturation():
    curves = [ForcCurve(a, np.array([a, 0.0, end]), np.array([a, 0.0, -0.5]), (-1.0, -0.9)) for a, end in
              ((1.0, -0.5), (2.0, -1.5))]  # fmt: skip
    table = ForcTable.from_curves(curves)
    assert (table.lower, table.y_lower) == (-1.5, -0.5)
    near = ForcTable.from_curves(curves[:1] + [ForcCurve(2.0, np.array([2.0, 1.0]), np.array([2.0, 1.5]))])
    assert (near.lower, near.y_lower) == (-1.0, -0.9)


# --- curves of a run, files, mistakes ------------------------------------------------------------------------------


def test_curves_of_a_run_are_mirrored_with_their_calibration_points():
    step = [-1, 0, 0, -1, 1, 1, 1, 1]
    field = [9.0, 2.0, 3.0, 9.1, 0.0, 1.0, 2.0, 3.0]
    moment = [1.0, 0.5, 0.6, 1.1, 0.1, 0.2, 0.4, 0.6]
    first, second = curves_from_run(run_of(step, field, moment))
    assert (first.alpha, first.saturation) == (-2.0, (-9.0, -1.0))
    assert second.saturation == (-9.1, -1.1)
    assert second.beta.tolist() == [0.0, -1.0, -2.0, -3.0]
    assert second.y.tolist() == [-0.1, -0.2, -0.4, -0.6]


def test_a_field_that_turns_back_is_no_first_order_curve():
    with pytest.raises(DataError, match=r"curve 0: the field turns back at 2 of 4 points"):
        curves_from_run(run_of([0] * 4, [0.0, 2.0, 1.0, 1.5], [0.0] * 4))
    noise = curves_from_run(run_of([0] * 21, [*range(20), 18.5], range(21)))
    assert noise[0].beta.size == 20
    with pytest.raises(DataError, match="protocol 'staircase'"):
        curves_from_run(run_of([0], [0.0], [0.0], protocol="staircase"))
    with pytest.raises(DataError, match="has no curves"):
        curves_from_run(run_of([-1, -1], [9.0, 9.0], [1.0, 1.0]))


def test_json_gives_the_same_table_back():
    table = ForcTable.from_curves(irregular_curves(7, trimmed=True), unit="mm")
    data = table.to_json()
    back = ForcTable.from_json(data)
    walk = np.random.default_rng(4).uniform(table.lower, table.upper, 500)
    assert np.array_equal(Preisach(back).simulate(walk), Preisach(table).simulate(walk))
    assert (back.unit, back.to_json()) == ("mm", data)
    del data["curves"][2]["beta"]
    with pytest.raises(DataError, match="damaged: KeyError\\('beta'\\)"):
        ForcTable.from_json(data)


def test_wrong_curves_are_refused_by_name():
    a = ForcCurve(1.0, np.array([1.0, 0.0]), np.array([1.0, 0.0]))
    with pytest.raises(DataError, match="at least two"):
        ForcTable.from_curves([a])
    with pytest.raises(DataError, match=r"have their peak at 1\. Average"):
        ForcTable.from_curves([a, a])
    with pytest.raises(DataError, match="starts at or below negative saturation"):
        ForcTable.from_curves([a, ForcCurve(0.0, np.array([0.0]), np.array([0.0]))])
    with pytest.raises(DataError, match="below negative saturation \\(0.5\\)"):
        ForcTable((a, ForcCurve(2.0, np.array([2.0]), np.array([2.0]))), 0.5, 0.0)
    with pytest.raises(DataError, match="β must start at the peak and fall strictly"):
        ForcCurve(1.0, np.array([1.0, 0.5, 0.5]), np.zeros(3))
    with pytest.raises(DataError, match="not a number"):
        ForcCurve(1.0, np.array([1.0, 0.5]), np.array([0.0, np.nan]))
    with pytest.raises(DataError, match="shape"):
        ForcCurve(1.0, np.array([1.0, 0.5]), np.zeros(3))
