"""The page of reversal curves: sentences that follow the figures, what each figure holds, and hostile units."""

import dataclasses

import numpy as np
import pytest

from identification.test_forc_diagram import gaussian_relays, relay_moments
from identification.test_forc_table import magnetic_run
from report.pages import Page, run_of
from smarig.core.errors import DataError, UsageError
from smarig.record import FORC_PROTOCOL, Run
from smarig.record.schema import SAMPLE_COLUMNS
from smarig.report import forc_page, run_page
from smarig.report.forc.forc_evidence import forc_assessment, forc_evidence

STEP = 3.0


def reversal_run(tmp_path, *, noise=2e-4, drift=0.0, unit="T", scale=1e-3, moment_unit="A m^2", ridge=False):
    """A magnetometer's run of 40 curves with calibration points; fields in mT times ``scale``."""
    random = np.random.default_rng(0)
    relays = gaussian_relays((40.0, 0.0), (12.0, 0.0 if ridge else 12.0))
    field, step = [], []
    for k, reversal in enumerate(30.0 - STEP * np.arange(40)):
        rising = np.arange(reversal, 120.0, STEP)
        field += [200.0, *rising]
        step += [-1.0] + [float(k)] * rising.size
    field, step = np.array(field), np.array(step)
    reversals = 30.0 - STEP * np.maximum(step, 0)
    moment = relay_moments(*relays, reversals, field) * (1 + drift * np.linspace(0, 1, field.size))
    moment = moment + noise * random.standard_normal(field.size)
    columns = {name: np.full(field.size, np.nan) for name in SAMPLE_COLUMNS}
    columns |= {"input": field * scale, "position": moment, "step": step}
    meta = {
        "protocol": FORC_PROTOCOL,
        "input": {"quantity": "magnetic field", "unit": unit},
        "output": {"quantity": "magnetic moment", "unit": moment_unit, "per_count": None},
        "imported": {"file": "sample.forc"},
        "complete": True,
    }
    return Run(tmp_path / "magnet.run.sqlite", meta, columns, (), ())


@pytest.fixture(scope="module")
def run(tmp_path_factory):
    """A run without drift."""
    return reversal_run(tmp_path_factory.mktemp("forc"))


@pytest.fixture(scope="module")
def evidence(run):
    """Its evidence."""
    return forc_evidence(run)


def test_the_page_opens_with_the_sentences_and_the_diagram(run):
    page = Page(forc_page(run))
    words = page.visible
    assert words.index("Measured: ") < words.index("FORC diagram")
    assert "40 first-order reversal curves" in words
    assert page.captions[0].startswith("FORC diagram")
    drawn = page.plots[0]["data"]
    assert [trace["type"] for trace in drawn].count("heatmap") == 1
    assert any(trace["type"] == "contour" for trace in drawn)
    assert "mT" in page.plots[0]["layout"]["xaxis"]["title"]["text"]


@pytest.mark.long("takes five seconds")
def test_a_run_of_reversal_curves_gets_this_page_from_report(run):
    assert "FORC diagram" in Page(run_page(run)).visible


@pytest.mark.long("takes two seconds")
def test_peak_and_widths_are_told_in_the_units_of_the_axes(evidence):
    peak = evidence.diagram.peak
    words = forc_assessment(evidence).measured
    assert f"H<sub>c</sub> = {1e3 * peak.half_width:.3g} mT" in words
    assert f"{1e3 * peak.fwhm_half_width:.3g} mT along" in words


@pytest.mark.long("takes three seconds", cases=("300.0-good",))
@pytest.mark.parametrize(
    ("ratio", "level"), [(300.0, "good"), (12.0, "good"), (7.0, "warning"), (4.5, "bad")]
)
def test_the_level_follows_the_peak(evidence, ratio, level):
    d = evidence.diagram
    place = np.unravel_index(np.nanargmax(d.mu), d.mu.shape)
    se = np.full_like(d.se, d.mu[place] / ratio)
    other = dataclasses.replace(evidence, diagram=dataclasses.replace(d, se=se))
    found = forc_assessment(other)
    assert found.level == level
    assert ("Do not read" in found.advice) == (level == "bad")


@pytest.mark.long("takes five seconds")
def test_noise_alone_is_called_unreadable(tmp_path):
    found = forc_assessment(forc_evidence(reversal_run(tmp_path, noise=10.0)))
    assert found.level in ("bad", "warning")
    assert "as they are" not in found.advice


@pytest.mark.long("takes five seconds")
def test_a_ridge_is_named_and_its_section_is_open(tmp_path):
    words = forc_page(reversal_run(tmp_path, ridge=True))
    assert "A central ridge lies at" in Page(words).visible
    assert "particles that do not interact" in Page(words).visible


@pytest.mark.long
def test_drift_is_shown_with_the_decision(tmp_path):
    run = reversal_run(tmp_path, drift=0.3, noise=1e-5)
    e = forc_evidence(run)
    assert e.drift is not None
    assert e.drift.kind == "multiplicative"
    assert "The multiplicative correction is applied" in Page(forc_page(run)).visible
    raw = forc_evidence(reversal_run(tmp_path, noise=1e-5))
    np.testing.assert_allclose(e.data.y / np.ptp(e.data.y), raw.data.y / np.ptp(raw.data.y), atol=4e-3)


@pytest.mark.long("takes three seconds")
def test_a_given_smoothing_is_told_as_given(run):
    words = Page(forc_page(run, smoothing=4.0)).visible
    assert "The smoothing factor 4 was given" in words
    assert "Choice of the smoothing factor" not in words
    with pytest.raises(UsageError, match="smoothing factor"):
        forc_page(run, smoothing=-1.0)


def test_an_impossible_factor_is_refused_before_the_data_are_read():
    with pytest.raises(UsageError, match="smoothing factor"):
        forc_page(run_of(), smoothing=float("nan"))


@pytest.mark.long("takes three seconds")
def test_units_of_a_file_never_become_markup(tmp_path):
    hostile = "<script>alert(1)</script>"
    html = forc_page(reversal_run(tmp_path, unit=hostile, moment_unit=hostile, scale=1.0))
    assert "<script>alert" not in html


def test_a_run_without_curves_is_refused_by_the_diagram_and_kept_by_report(tmp_path):
    run = reversal_run(tmp_path)
    keep = run["step"] < 1
    columns = {name: run[name][keep] for name in SAMPLE_COLUMNS}
    one = Run(run.path, run.meta, columns, (), ())
    with pytest.raises(DataError):
        forc_page(one)
    assert "FORC diagram" not in Page(run_page(one)).visible


@pytest.mark.parametrize(
    ("name", "h_c", "h_u", "ridge"),
    [
        pytest.param("UB199BF", 0.058, -0.004, False, marks=pytest.mark.long),
        pytest.param("hchb_forc", 942.0, 21.0, True, marks=pytest.mark.long("takes ten seconds")),
        pytest.param("MSM33-55-1_d330.forc", None, 0.0, True, marks=pytest.mark.long("takes five seconds")),
    ],
)
def test_measured_files_peak_where_others_find_the_peak(name, h_c, h_u, ridge):
    """H_c and H_u of the peak by PmagPy 4.5.2; a broad glass, nanowires, and a sediment with magnetosomes."""
    e = forc_evidence(magnetic_run(name))
    assert e.ridge.present == ridge
    assert e.ridge.centre == pytest.approx(h_u, abs=2 * min(e.diagram.estimate.steps))
    if h_c:
        assert e.diagram.peak.half_width == pytest.approx(h_c, abs=2 * min(e.diagram.estimate.steps))
