"""The operator against relays switched one by one: the same output to rounding, for any history."""

import numpy as np
import pytest

from preisach.relay_reference import TABLE_5_1, Printed, Relays, cells, histories, lower_half
from smarig.preisach.hysteresis.fod_table import FodTable
from smarig.preisach.hysteresis.gorbet_1997 import THESIS_PARTITIONS, thesis_surface
from smarig.preisach.hysteresis.mirrored import Mirrored
from smarig.preisach.hysteresis.relay_measure import RelayMeasure
from smarig.preisach.operator import Preisach

TOLERANCE = 1e-12  # of the output range, design.md §4.5
HISTORIES = tuple(histories(np.arange(20.0), 0))
SIDE = np.array(
    [7.0, 15.0, 24.5, 37.0, 45.0, 60.0, 75.0, 90.0, 99.0, 100.0, 101.0, 102.0, 125.0, 145.0, 185.0]
)
TWO_WIRE = np.concatenate([-SIDE[::-1], [0.0], SIDE])
ONE_WIRE = np.unique(
    [*THESIS_PARTITIONS["one_wire"], 3.1, 12.0, 20.0, 35.5, 50.0, 75.0, 100.0, 101.0, 102.0, 125.0]
)
EVEN = np.linspace(-185.0, 185.0, 21)


def levels_of(name: str) -> np.ndarray:
    return TWO_WIRE if name.startswith("two") else ONE_WIRE


def start(op: Preisach, centre: float | None) -> None:
    if centre is None:
        op.reset("negative")
    else:
        op.go_to_diagonal(centre)


def worst(op: Preisach, relays: Relays, y_lower: float, inputs: np.ndarray) -> float:
    """Largest deviation from the relays along the inputs."""
    here = [op.step(u) for u in inputs]
    assert np.ptp(here) > 0, "the input must move the output"
    return float(np.max(np.abs(here - relays.drive(inputs, y_lower))))


@pytest.mark.long("one of each kind", one_of_each=True)
@pytest.mark.parametrize("history", HISTORIES)
@pytest.mark.parametrize("initial", ["negative", "anhysteretic"])
@pytest.mark.parametrize("name", TABLE_5_1)
def test_surface_is_its_relays(name: str, initial: str, history: str):
    printed, levels = Printed(name), levels_of(name)
    centre = None if initial == "negative" else 0.0
    relays = cells(levels, printed.y, centre, lower_half(printed.y_alpha_beta))
    op = Preisach(thesis_surface(name))
    start(op, centre)
    assert op.y == pytest.approx(printed.y_lower + relays.nu[relays.on].sum(), abs=TOLERANCE * printed.range)
    assert worst(op, relays, printed.y_lower, histories(levels, 1)[history]) <= TOLERANCE * printed.range


@pytest.mark.long("one of each kind", one_of_each=True)
@pytest.mark.parametrize("centre", EVEN[2::3])
@pytest.mark.parametrize("name", ["two_c", "two_p", "two_e"])
def test_surface_is_its_relays_from_any_diagonal(name: str, centre: float):
    """B_ℓ with ℓ ≠ 0 (§8.3): clipped at one side of the triangle, cut cells everywhere else."""
    printed, relative = Printed(name), TOLERANCE * Printed(name).range
    for inputs in histories(EVEN, 2).values():
        relays = cells(EVEN, printed.y, centre, lower_half(printed.y_alpha_beta))
        op = Preisach(thesis_surface(name))
        assert op.go_to_diagonal(centre) == pytest.approx(
            printed.y_lower + relays.nu[relays.on].sum(), abs=relative
        )
        assert worst(op, relays, printed.y_lower, inputs) <= relative


@pytest.mark.parametrize("name", TABLE_5_1)
def test_printed_reference_differentiates_itself(name: str):
    """The reference's own derivatives, by complex step and by a difference of complex steps."""
    p, h = Printed(name), 1e-4
    a = np.linspace(p.lower + 1, p.upper, 23)[:, None]
    b = np.linspace(p.lower, p.upper, 19)
    y_beta = p.y(a, b + 1e-30j).imag / 1e-30
    assert np.allclose(p.y_beta(a, b), y_beta, rtol=1e-12, atol=1e-15)
    mixed = (p.y_beta(a + h, b) - p.y_beta(a - h, b)) / (2 * h)
    assert np.allclose(p.y_alpha_beta(a, b), mixed, rtol=1e-5, atol=1e-8)


# --- tables -----------------------------------------------------------------------------------------


def random_table(nodes: np.ndarray, seed: int) -> np.ndarray:
    """FOD values of arbitrary signed cell masses: nothing a surface could be mistaken for."""
    rng = np.random.default_rng(seed)
    n = nodes.size
    y = np.full((n, n), np.nan)
    y[:, 0] = -4.2
    for i in range(1, n):
        steps = rng.normal(0.6, 0.5, i)
        y[i, 1 : i + 1] = y[i, 0] + np.cumsum(steps)
    return y


def bilinear_relays(nodes: np.ndarray, y: np.ndarray, levels: np.ndarray, centre: float | None) -> Relays:
    """A table's relays: a node cell's mass lies evenly over its area, a diagonal cell's along α = β."""
    rows = []
    for i in range(1, len(levels)):
        for j in range(i):
            middle_a, middle_b = (levels[i] + levels[i - 1]) / 2, (levels[j] + levels[j + 1]) / 2
            p, q = np.searchsorted(nodes, middle_a), np.searchsorted(nodes, middle_b)
            width = nodes[p] - nodes[p - 1]
            fine = (levels[i] - levels[i - 1], levels[j + 1] - levels[j])
            if p == q:
                mass = (y[p, p] - y[p, p - 1]) * fine[0] / width if j == i - 1 else 0.0
            else:
                whole = y[p, q] - y[p, q - 1] - y[p - 1, q] + y[p - 1, q - 1]
                mass = whole * fine[0] / width * fine[1] / (nodes[q] - nodes[q - 1])
            on = centre is not None and (levels[i] + levels[j + 1] <= 2 * centre or levels[i] <= centre)
            if centre is not None and j < i - 1 and levels[i] + levels[j] == 2 * centre:
                rows += [(levels[i], levels[j], mass / 2, True), (levels[i], levels[j], mass / 2, False)]
            else:
                rows.append((levels[i], levels[j], mass, on))
    alpha, beta, nu, on = (np.array(column) for column in zip(*rows))
    return Relays(alpha, beta, nu, on, levels[0] if centre is None else centre)


@pytest.mark.parametrize("history", HISTORIES)
@pytest.mark.parametrize("centre", [None, 0.0])
def test_table_is_its_relays(centre: float | None, history: str):
    nodes = np.array([-40.0, -25.0, -8.0, -3.0, 3.0, 8.0, 25.0, 40.0])
    levels = np.unique([*nodes, *np.arange(-38, 40, 5.0), *np.arange(-37, 40, 5.0)[::-1], 0.0, 38.0, -38.0])
    levels = np.unique([*levels, *-levels])
    y = random_table(nodes, 3)
    op = Preisach(FodTable.from_arrays(nodes, nodes, y))
    start(op, centre)
    relays = bilinear_relays(nodes, y, levels, centre)
    range_ = float(np.nanmax(y) - np.nanmin(y))
    assert worst(op, relays, -4.2, histories(levels, 4)[history]) <= TOLERANCE * range_


def test_table_returns_its_own_data():
    """FOD inputs along the partition give back the table: exact at the nodes."""
    nodes = np.array(THESIS_PARTITIONS["two_wire"])
    y = random_table(nodes, 5)
    op = Preisach.from_table(nodes, nodes, y)
    for i in range(1, nodes.size):
        out = op.simulate([nodes[i], *nodes[:i][::-1]])
        assert np.allclose(out, y[i, : i + 1][::-1], atol=1e-13)


# --- measures ---------------------------------------------------------------------------------------


def random_measure(seed: int, count: int = 120) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Relays on a lattice of thresholds, some degenerate (α = β), masses of either sign."""
    rng = np.random.default_rng(seed)
    thresholds = np.array(
        [0.0, 50.0, 120.0, 180.0, 240.0, 280.0, 299.0, 300.0, 300.5, 301.0, 302.0, 350.0, 400.0]
    )
    pair = np.sort(rng.choice(thresholds, (count, 2)), axis=1)
    pair = pair[pair[:, 0] < 400.0]  # none degenerate at positive saturation, where none would be seen
    pair = pair[pair[:, 1] > 0.0]
    pair = np.vstack([pair, [[0.0, 400.0], [240.0, 240.0]]])  # the range, and one that is all tie
    return pair[:, 1], pair[:, 0], rng.normal(0.3, 1.0, len(pair)), thresholds


@pytest.mark.parametrize("history", HISTORIES)
@pytest.mark.parametrize("centre", [None, 175.0, 240.0])
def test_measure_is_its_relays(centre: float | None, history: str):
    """Inputs on the thresholds themselves and between them; ties follow the stated convention."""
    alpha, beta, mass, thresholds = random_measure(7)
    op = Preisach.from_measure(alpha, beta, mass)
    start(op, centre)
    on = (
        np.zeros(alpha.size, dtype=bool)
        if centre is None
        else (alpha + beta < 2 * centre) | (alpha <= centre)
    )
    relays = Relays(alpha, beta, 2 * mass, on, op.u)
    levels = np.sort(np.concatenate([thresholds, thresholds[:-1] + np.diff(thresholds) / 3]))
    assert worst(op, relays, -mass.sum(), histories(levels, 8)[history]) <= TOLERANCE * 2 * np.abs(mass).sum()


def test_one_jump_past_the_last_maximum():
    """301, 300, then 302 in one move: the loop 301–300 is wiped out and the older memory rises on."""
    alpha, beta, mass, _ = random_measure(9)
    op = Preisach.from_measure(alpha, beta, mass)
    relays = Relays(alpha, beta, 2 * mass, np.zeros(alpha.size, dtype=bool), 0.0)
    inputs = np.array([320.0, 180.0, 301.0, 300.0, 302.0])
    assert worst(op, relays, -mass.sum(), inputs) <= 1e-12
    assert op.state.extrema == (0.0, 320.0, 180.0)


@pytest.mark.parametrize("name", ["one_p", "two_e"])
def test_mirror_is_its_mirrored_relays(name: str):
    printed, levels = Printed(name), levels_of(name)
    op = Preisach(Mirrored(thesis_surface(name)), "positive")
    for inputs in histories(levels, 10).values():
        op.reset("positive")
        relays = cells(levels, printed.y, None)
        here = np.array([op.step(-u) for u in inputs])
        assert np.max(np.abs(here + relays.drive(inputs, printed.y_lower))) <= TOLERANCE * printed.range


def test_measure_of_a_table_is_the_table():
    """Two representations of one hysteresis: relays on the cells of a level grid, driven on its levels."""
    printed = Printed("two_c")
    relays = cells(TWO_WIRE, printed.y, None)
    measure = RelayMeasure.from_arrays(relays.alpha, relays.beta, relays.nu / 2)
    offset = printed.y_lower + relays.nu.sum() / 2  # §3.2.6: relays alone are symmetric about zero
    inputs = histories(TWO_WIRE, 11)["random"]
    by_measure = Preisach(measure).simulate(inputs) + offset
    assert (
        np.max(np.abs(by_measure - Preisach(thesis_surface("two_c")).simulate(inputs)))
        <= TOLERANCE * printed.range
    )
