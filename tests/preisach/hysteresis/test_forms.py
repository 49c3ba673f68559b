"""The contract of every form of the surface (5.5); a new form is one file, from its fit to its page."""

from pathlib import Path

import numpy as np
import pytest

from identification.made_runs import fod_inputs, made_run
from report.pages import Page
from smarig.core.catalogue import own_files, resolve_name
from smarig.core.errors import DataError, UsageError
from smarig.identification.fod_data import fod_data
from smarig.identification.identify import identify
from smarig.identification.surface.surface_fit import fit_surface
from smarig.identification.surface.surface_kinds import kinds_by_freedom, surface_kinds
from smarig.identification.verify import verify
from smarig.preisach import compiled
from smarig.preisach.hysteresis.fod_surface import FodSurface
from smarig.preisach.hysteresis.gorbet_1997 import THESIS_PARTITIONS, thesis_surface
from smarig.preisach.hysteresis.hysteresis_json import dump_hysteresis, load_hysteresis
from smarig.preisach.hysteresis.surface_form import FORMS, surface_form, surface_forms
from smarig.preisach.interval import Interval, shift_bounds
from smarig.preisach.operator import Preisach
from smarig.replay.model_file import load_model
from smarig.report.components.style import INK, surface_colour
from smarig.report.model_comparison_page import models_page
from smarig.report.models.first_order_figures import replay_figure
from smarig.report.models.model_tables import parameters_table
from smarig.theory.energy import certify
from smarig.theory.properties.classes import classes

OWN = Path(__file__).with_name("logistic.py")
STEP = (0.04, -43.0, 0.1, 40.0, 0.06, -80.0, -45.0)
RANGES = {"one_c": (0.0, 174.1), "two_c": (-185.0, 185.0)}


@pytest.fixture(autouse=True)
def own_form():
    """The own form is loaded by its path, and removed after each test."""
    with own_files():
        yield resolve_name(FORMS, str(OWN))


@pytest.fixture(params=[*surface_forms(), "logistic"])
def form(request):
    return request.param


def grown(form):
    """(x, u₋, u₊) of every third of the form's own starts, over the ranges of both wires."""
    found = surface_form(form)
    for name, (lower, upper) in RANGES.items():
        fitted = thesis_surface(name).x if found.grows_from else ()
        for x in found.starts(lower, upper, fitted)[::3]:
            yield x, lower, upper


def shape(form, x, lower, upper):
    return FodSurface(form, x, lower, upper, 1.0, 11.0)


# --- the contract -------------------------------------------------------------------------------------------


def test_the_slope_is_the_derivative_of_the_value(form):
    found = surface_form(form)
    for x, lower, upper in grown(form):
        alpha, h = np.linspace(lower, upper, 41), 1e-5 * (upper - lower)
        f = found.value(x[3:], alpha)
        numeric = (found.value(x[3:], alpha + h) - found.value(x[3:], alpha - h)) / (2 * h)
        assert found.slope(x[3:], alpha) == pytest.approx(numeric, rel=1e-5, abs=1e-7 * (1 + np.abs(f).max()))


def test_the_jacobian_is_the_derivative_by_each_parameter(form):
    found = surface_form(form)
    for x, lower, upper in grown(form):
        alpha, own = np.linspace(lower, upper, 41), np.array(x[3:])
        for k, column in enumerate(found.jacobian(x[3:], alpha).T):
            h = 1e-6 * (abs(own[k]) or 1 / (upper - lower))
            at = [found.value(tuple(own + sign * h * np.eye(own.size)[k]), alpha) for sign in (1, -1)]
            scale = np.abs(column).max() + np.abs(at[0]).max() * 1e-8 / h
            assert column == pytest.approx((at[0] - at[1]) / (2 * h), rel=1e-5, abs=1e-5 * scale)
        assert found.jacobian(x[3:], alpha).shape == (41, len(x) - 3)


def test_starts_are_finite_and_within_the_bounds(form):
    found = surface_form(form)
    for x, lower, upper in grown(form):
        assert len(x) == len(found.parameters)
        assert np.isfinite(x).all()
        bounds = found.bounds(lower, upper)
        assert set(bounds) <= set(found.powers)
        for name, (low, high) in bounds.items():
            assert low <= x[found.parameters.index(name)] <= high


def test_the_value_in_plain_numbers_is_the_value_in_arrays(form):
    for x, lower, upper in grown(form):
        s = shape(form, x, lower, upper)
        if float(s.shape(upper, upper)) < 1e-3:  # hardly any height: differences of y lose their digits
            continue
        beta, alpha = np.sort(np.random.default_rng(1).uniform(lower, upper, (2, 60)), axis=0)
        scalar = [s.everett(a, b) for a, b in zip(alpha.tolist(), beta.tolist())]
        expected = s.y(alpha, alpha) - s.y(alpha, beta)
        assert scalar == pytest.approx(expected, rel=1e-9, abs=1e-9 * max(scalar))
        assert s.swept(alpha, beta) == pytest.approx(scalar, rel=1e-12, abs=1e-12 * max(scalar))


@pytest.mark.skipif(not compiled.compiled_available(), reason="needs numba")
def test_the_value_in_plain_numbers_can_be_compiled(form):
    import numba

    x, lower, upper = next(g for g in grown(form) if shape(form, *g).shape(g[2], g[2]) > 1e-3)
    s = shape(form, x, lower, upper)
    beta, alpha = np.sort(np.random.default_rng(2).uniform(lower, upper, (2, 20)), axis=0)
    fast = numba.njit(surface_form(form).between)
    made = [fast(s.keyed.params, a, b) for a, b in zip(alpha.tolist(), beta.tolist())]
    assert made == pytest.approx([s.everett(a, b) for a, b in zip(alpha.tolist(), beta.tolist())])


def test_value_and_slope_stay_within_their_ranges_between_turning_points(form):
    """The proofs of the theory rest on this: no α in an interval leaves what ``interval.shift`` encloses."""
    rng, found = np.random.default_rng(3), surface_form(form)
    for x, lower, upper in grown(form):
        s, ends = shape(form, x, lower, upper), np.sort(rng.uniform(lower, upper, (2, 30)), axis=0)
        inside = ends[0] + np.linspace(0, 1, 101)[:, None] * (ends[1] - ends[0])
        values, slopes = shift_bounds(s, Interval(*ends))
        for held, at in ((values, found.value(x[3:], inside)), (slopes, found.slope(x[3:], inside))):
            slack = 1e-12 * np.abs(at).max()
            assert np.all(held.low - slack <= at)
            assert np.all(at <= held.high + slack)


def test_every_parameter_has_a_unit_and_every_form_its_colour(form):
    found = surface_form(form)
    assert list(found.units("K")) == list(found.parameters)
    assert set(found.units("K").values()) <= {"K", "1/K", "1"}
    assert surface_colour(form) == found.colour != INK
    assert len({surface_colour(kind) for kind in surface_kinds()}) == len(surface_kinds())


# --- unknown names ------------------------------------------------------------------------------------------


KNOWN = "'cubic' must be one of constant, parabolic, exponential, logistic"


@pytest.mark.parametrize(
    "use",
    [
        lambda: surface_form("cubic"),
        lambda: FodSurface("cubic", thesis_surface("one_e").x, 0.0, 174.1, 0.0, 12.5),
        lambda: fit_surface(fod_data(stepped_run()), "cubic"),
    ],
)
def test_an_unknown_form_is_an_error_that_lists_the_known_ones(use):
    with pytest.raises(UsageError, match=KNOWN):
        use()


def test_an_unknown_form_in_a_model_file_is_an_error_that_lists_the_known_ones():
    data = dump_hysteresis(thesis_surface("one_e")) | {"form": "cubic"}
    with pytest.raises(DataError, match=KNOWN):
        load_hysteresis(data)


def test_an_unknown_kind_of_surface_is_an_error_that_lists_the_known_ones():
    with pytest.raises(UsageError, match="exponential, logistic, positive, table, best"):
        identify(stepped_run(), "cubic")


@pytest.mark.parametrize(
    ("text", "sentence"),
    [
        ("odd = 3", r"odd must be a SurfaceForm .*; it is of type int"),
        (
            OWN.read_text(encoding="utf-8").replace("logistic = LogisticForm()", "odd = LogisticForm"),
            "the class",
        ),
        ("f = 3", "defines no 'odd'"),
        (
            OWN.read_text(encoding="utf-8")
            .replace('colour = "#F0E442"', "")
            .replace("logistic = LogisticForm()", "odd = LogisticForm()"),
            "odd has no colour",
        ),
    ],
)
def test_a_file_that_is_no_form_is_refused_with_the_reason(tmp_path, text, sentence):
    (tmp_path / "odd.py").write_text(text, encoding="utf-8")
    with pytest.raises(UsageError, match=sentence):
        resolve_name(FORMS, str(tmp_path / "odd.py"))


# --- a new form, from its fit to its page -------------------------------------------------------------------


def stepped_run(seed=None, partition=THESIS_PARTITIONS["one_wire"]):
    """First-order curves of a wire whose curves shift by a step, which no shipped form follows."""
    truth = FodSurface("logistic", STEP, 0.0, 174.1, 0.0, 12.54, "mm")
    inputs = fod_inputs(partition)
    y = Preisach(truth).simulate(inputs)
    noise = 0.0 if seed is None else 0.01 * np.random.default_rng(seed).standard_normal(y.size)
    return made_run(inputs, y + noise)


def test_a_new_form_joins_every_list_by_its_file_alone():
    assert kinds_by_freedom() == (
        ("constant",),
        ("parabolic", "exponential"),
        ("logistic",),
        ("positive",),
        ("table",),
    )


@pytest.mark.long("takes three seconds")
def test_a_new_form_is_identified_saved_verified_and_reported(tmp_path):
    run, other = stepped_run(), stepped_run(partition=np.linspace(0.0, 174.1, 8))
    found = {name: identify(run, name) for name in ("constant", "exponential", "logistic")}
    rms = {name: each.model.fit["rms"] for name, each in found.items()}
    assert rms["logistic"] < 1e-6 < 0.01 < rms["exponential"] < rms["constant"]
    assert found["logistic"].fit.determined
    assert found["logistic"].fit.values[:7] == pytest.approx(STEP, rel=1e-4)

    path = found["logistic"].model.save(tmp_path / "logistic.model.json")
    model = load_model(path)
    assert model.hysteresis == found["logistic"].model.hysteresis
    assert "logistic FodSurface" in repr(model)
    (judged,) = verify(model, other).to_json()["runs"]
    assert judged["rms"] < 1e-5

    page = Page(models_page({"logistic": model, "constant": found["constant"].model}, {"v": other}))
    assert "10⁻" in page.row("logistic on v")[2]  # its rms, rounding alone
    assert float(page.row("constant on v")[2]) > 0.01
    table = str(parameters_table(found["logistic"]))
    assert all(name in table for name in ("x₅", "x₈", "1/K"))
    names = [trace["name"] for panel in replay_figure(found, run).panels for trace in panel.data]
    assert "model, f logistic" in names

    with (
        own_files(),
        pytest.raises(DataError, match="'logistic' must be one of constant, parabolic, exponential"),
    ):
        load_model(path)


@pytest.mark.long("takes two seconds")
def test_a_new_form_is_the_best_where_it_alone_follows_the_curves():
    best = identify(stepped_run(seed=1))
    assert best.surface == "logistic"
    assert best.choice is not None
    assert list(best.choice.held_out_rms) == list(surface_kinds())


@pytest.mark.long("takes two seconds")
def test_bounds_of_a_new_form_are_proved_as_those_of_the_shipped_ones():
    s = FodSurface("logistic", STEP, 0.0, 174.1, 0.0, 12.54, "mm")
    u = np.linspace(0.0, 174.1, 400)
    a, b = np.meshgrid(u, u, indexing="ij")
    mu, found = s.density(a, b)[b <= a], classes(s)
    assert found.mu_min.bound <= mu.min()
    assert mu.max() <= found.mu_max.bound
    assert certify(s).dissipative is not None
