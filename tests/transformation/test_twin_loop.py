"""Temperatures of a twin's run against those of the exact major loop of its Preisach operator."""

from dataclasses import replace

import numpy as np
import pytest

import smarig
from smarig.config import actuator_text
from smarig.preisach import Preisach, thesis_surface
from smarig.transformation import run_figures
from transformation.second_tangents import corners, steepest


@pytest.fixture(scope="module")
def run(tmp_path_factory):
    out = tmp_path_factory.mktemp("cycles") / "cycles.run.sqlite"
    return smarig.run("constant_force_cycles", rig="one_wire_twin", out=out, seed=1, cycles=1, points=40)


@pytest.fixture(scope="module")
def exact():
    """(u, y) of the exact heating and cooling branch over the twin's range."""
    u = np.linspace(0.0, 174.1, 1742)
    wire = Preisach(thesis_surface("one_e"))
    heating = wire.simulate(u)
    both = wire.simulate(np.concatenate([u, u[::-1]]))
    return (u, heating), (u[::-1], both[u.size :])


def test_the_lag_of_a_wave_on_an_own_actuator_is_that_of_its_record(tmp_path):
    """Its file is nowhere any more; without a settled step the time constant of the wire is a lag."""
    (tmp_path / "mine.toml").write_text(
        'base = "one_wire_twin"\nname = "mine"\nactuator = "./my_wire.toml"\n', encoding="utf-8"
    )
    text = actuator_text("gorbet_one_wire").replace("gorbet_one_wire", "my_wire")
    (tmp_path / "my_wire.toml").write_text(text, encoding="utf-8")
    smarig.run(
        "minor_loops",
        rig=str(tmp_path / "mine.toml"),
        out=(out := tmp_path / "a.run.sqlite"),
        low_A=0,
        high_A=0.95,
        loops=1,
        loop_s=90,
    )
    (tmp_path / "my_wire.toml").unlink()
    assert run_figures(smarig.load_run(out)).means["stroke"].value == pytest.approx(12, abs=0.5)  # mm


@pytest.mark.long("takes five seconds")
def test_the_temperatures_of_the_run_are_those_of_the_exact_loop(run, exact):
    found, (heating, cooling) = run_figures(run), exact
    a_s, a_f = corners(*heating)
    _, m_s = corners(*cooling)
    steep, _ = steepest(cooling[0][::-1], cooling[1][::-1])
    m_f = (heating[1][0] - steep.intercept) / steep.slope  # on the plateau of the heating branch
    for name, true in {"A_s": a_s, "A_f": a_f, "M_s": m_s, "M_f": m_f}.items():
        low, high = found.means[name].ci95
        assert low - 0.3 <= true <= high + 0.3, name
    assert found.means["stroke"].value == pytest.approx(np.ptp(heating[1]), abs=0.02)
    assert abs(found.means["residual"].value) < 0.02
    assert found.cycles[0].borrowed == ("M_f",)


@pytest.mark.long("takes five seconds")
def test_both_scales_are_given(run):
    found = smarig.transformation_temperatures(run).to_json()["runs"][0]
    one = found["figures"]["A_s"]
    assert one["degC"] == pytest.approx(one["value"] + 22.0, abs=0.1)
    assert one["above_ambient_K"] == pytest.approx(one["value"])
    assert found["ambient_degC"] == pytest.approx(22.0, abs=0.1)
    assert found["twin"] is True


@pytest.mark.long("takes five seconds")
def test_temperatures_that_no_thermometer_measured_say_so(run):
    assert any("No thermometer measured these temperatures" in note for note in run_figures(run).notes)
    quantity = {**run.meta["input"], "from": "thermocouple"}
    measured = replace(run, meta={**run.meta, "input": quantity})
    assert not any("No thermometer" in note for note in run_figures(measured).notes)


@pytest.mark.long("takes three seconds")
def test_first_order_curves_give_an_assembled_heating_branch(tmp_path):
    levels = ",".join(f"{174.1 * k / 11:.3f}" for k in range(12))
    first = smarig.run(
        "first_order_descending",
        rig="one_wire_twin",
        out=tmp_path / "fod.run.sqlite",
        seed=1,
        partition_K=levels,
    )
    found = run_figures(first)
    assert found.cycles[0].assembled == ("heating",)
    assert "residual" not in found.means
    exact = Preisach(thesis_surface("one_e")).simulate(found.cycles[0].heating.u)
    assert np.abs(found.cycles[0].heating.y - exact).max() < 0.1, (
        "mm: the rising points lie on the major loop"
    )
    assert any("covers" in u.reason for u in found.unused)
