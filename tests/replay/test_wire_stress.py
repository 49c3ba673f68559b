"""The stress of two wires over a run: the printed ratio of §5.5.1, a root finder where both are hot, the guard."""

import json
from dataclasses import replace

import numpy as np
import pytest
from scipy.optimize import brentq

import smarig
from smarig.cli import run as cli
from smarig.plant import Actuator
from smarig.replay import stress_over_run

WIRE = Actuator.named("gorbet_two_wire")
HEATING, COOLING, AMBIENT = (53.0, 80.0), (19.0, 47.0), 22.0  # A_s, A_f, M_f, M_s of §2.4.1, °C


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
    """A wire that has cooled to the room, 3 °C above M_f, keeps some austenite; it adds to that of the second."""
    first = replace(run, columns=run.columns | {"current_A": np.maximum(run["current_A"], 0.0)})
    alone, both = stress_over_run(first, WIRE), stress_over_run(run, WIRE)
    assert alone.cold_MPa == pytest.approx(242.03, abs=0.01)
    assert alone.change_percent == pytest.approx(7.76, abs=0.01)
    assert alone.least_MPa == pytest.approx(alone.cold_MPa, abs=0.5)
    kept = (AMBIENT + 185.0 * 0.05**2 - 19.0) / (47.0 - 19.0)
    most = brentq(lambda s: strain(s, 1.0) + strain(s, kept) - 0.06, 0, 2000)
    assert both.most_MPa == pytest.approx(most, abs=0.5)  # it cools on


def test_a_second_wire_that_is_heated_too_early_adds_stress(run):
    """The currents change their sign every 6 s; heating, in its own words, and the balance by a root finder."""
    n = 600
    current = np.where(np.arange(n) // 60 % 2, -1.0, 1.0)
    columns = {name: np.full(n, np.nan) for name in run.columns} | {
        "tick": np.arange(1.0, n + 1),
        "current_A": current,
    }
    found = stress_over_run(replace(run, columns=columns), WIRE)
    T, phases, most = np.zeros(2), np.zeros(2), 0.0
    for i in current.tolist():
        target = 185.0 * np.array([i > 0, i < 0]) * i**2
        T = target + (T - target) * np.exp(-0.1 / WIRE.tau_s)
        least, largest = (np.interp(AMBIENT + T, ends, (0.0, 1.0)) for ends in (HEATING, COOLING))
        both = phases = np.clip(phases, least, np.maximum(least, largest))
        most = max(
            most, brentq(lambda s, x=both: strain(s, x[0]) + strain(s, x[1]) - 0.06, 0, 2000, xtol=1e-9)
        )
    assert found is not None
    assert most > 300
    assert found.most_MPa == pytest.approx(most, rel=1e-6)


def test_the_initialisation_of_the_thesis_reaches_what_the_guard_of_a_bench_would_refuse(tmp_path):
    """Both wires hot: 1078 MPa. A rig with a limit stays below it, by the same figure."""
    free = smarig.run("initialise", rig="two_wire_twin", out=tmp_path / "a.run.sqlite", method="thesis")
    assert stress_over_run(free, WIRE).most_MPa == pytest.approx(1078, abs=1)
    (tmp_path / "limited.toml").write_text(
        'base = "two_wire_twin"\nname = "limited"\n[limits]\nstress_max_MPa = 300.0\n', encoding="utf-8"
    )
    rig = str(tmp_path / "limited.toml")
    limited = smarig.run("initialise", rig=rig, out=tmp_path / "b.run.sqlite", method="thesis")
    assert 261 < stress_over_run(limited, WIRE).most_MPa <= 300


@pytest.mark.long("takes three seconds")
def test_it_stands_in_the_json_and_on_the_page_of_two_preisach_wires_only(run, tmp_path, capsys):
    assert cli(["report", str(run.path), "-o", str(tmp_path / "a.html"), "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["stress"]["change_percent"] == pytest.approx(9.79, abs=0.02)
    assert "Stress in the wires" in (tmp_path / "a.html").read_text(encoding="utf-8")
    for rig in ("one_wire_twin", "two_wire_thermomechanical"):
        other = smarig.run("validation", rig=rig, out=tmp_path / f"{rig}.run.sqlite", points=2)
        assert cli(["report", str(other.path), "--json"]) == 0
        assert "stress" not in json.loads(capsys.readouterr().out)
