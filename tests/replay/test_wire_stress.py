"""The stress of two wires over a run: against the printed ratio of §5.5.1, and a root finder where both are hot."""

import json
from dataclasses import replace

import numpy as np
import pytest
from scipy.optimize import brentq

import smarig
from smarig.cli import run as cli
from smarig.plant import Actuator, WirePhases
from smarig.preisach import thesis_surface
from smarig.replay import stress_over_run

WIRE, SURFACE = Actuator.named("gorbet_two_wire"), thesis_surface("two_e")


def strain(stress_MPa, austenite):
    """A wire in parts of both phases, one after the other."""
    knee = 16800 * 0.0136
    martensite = stress_MPa / 16800 if stress_MPa <= knee else 0.0136 + (stress_MPa - knee) / 826
    return (1 - austenite) * martensite + austenite * stress_MPa / 35917


@pytest.fixture(scope="module")
def run(tmp_path_factory):
    """One wire is heated fully and cools before the other is."""
    out = tmp_path_factory.mktemp("stress") / "a.run.sqlite"
    return smarig.run(
        "step_currents", rig="two_wire_twin", out=out, seed=1, currents_A=(1.0, 0.05, -1.0, -0.05)
    )


@pytest.mark.long("takes three seconds")
def test_one_hot_wire_gives_the_change_of_the_thesis(run):
    found = stress_over_run(run, WIRE, SURFACE)
    assert found is not None
    assert found.cold_MPa == pytest.approx(242.03, abs=0.01)
    assert found.change_percent == pytest.approx(7.76, abs=0.01)
    assert found.least_MPa == pytest.approx(found.cold_MPa, abs=0.5)


def test_a_second_wire_that_is_heated_too_early_adds_stress(run):
    """The currents change their sign every 6 s; heating, in its own words, and the balance by a root finder."""
    n = 600
    current = np.where(np.arange(n) // 60 % 2, -1.0, 1.0)
    columns = {name: np.full(n, np.nan) for name in run.columns} | {
        "tick": np.arange(1.0, n + 1),
        "current_A": current,
    }
    found = stress_over_run(replace(run, columns=columns), WIRE, SURFACE)
    T, phases, most = np.zeros(2), WirePhases(SURFACE), 0.0
    for i in current.tolist():
        target = 185.0 * np.array([i > 0, i < 0]) * i**2
        T = target + (T - target) * np.exp(-0.1 / WIRE.tau_s)
        phases.step(T.tolist())
        both = phases.austenite
        most = max(
            most, brentq(lambda s, x=both: strain(s, x[0]) + strain(s, x[1]) - 0.06, 0, 2000, xtol=1e-9)
        )
    assert found is not None
    assert most > 300
    assert found.most_MPa == pytest.approx(most, rel=1e-6)


@pytest.mark.long("takes three seconds")
def test_it_stands_in_the_json_and_on_the_page_of_two_preisach_wires_only(run, tmp_path, capsys):
    assert cli(["report", str(run.path), "-o", str(tmp_path / "a.html"), "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["stress"]["change_percent"] == pytest.approx(7.76)
    assert "Stress in the wires" in (tmp_path / "a.html").read_text(encoding="utf-8")
    for rig in ("one_wire_twin", "two_wire_thermomechanical"):
        other = smarig.run("validation", rig=rig, out=tmp_path / f"{rig}.run.sqlite", points=2)
        assert cli(["report", str(other.path), "--json"]) == 0
        assert "stress" not in json.loads(capsys.readouterr().out)
