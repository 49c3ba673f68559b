"""Runs under a load: it is recorded, it moves the wire, and a load that changes is not taken up again."""

import json

import numpy as np
import pytest

from smarig.cli import run as cli
from smarig.core import Interrupted, UsageError
from smarig.plant import Actuator, Material, isothermal_loop
from smarig.record import load_run
from smarig.replay import load_of_run, stress_strain
from smarig.runner import Session, resume

RIG, SECTION_MM2 = "one_wire_thermomechanical", np.pi / 4 * 0.3**2
CHAMBER_DEGC = 72.0


def test_the_command_records_the_load_of_a_run(tmp_path):
    out = tmp_path / "a.run.sqlite"
    args = [
        "--rig",
        RIG,
        "--load",
        "24",
        "--set",
        "points=2",
        "-o",
        str(out),
        "--quiet",
    ]
    assert cli(["run", "validation", *args]) == 0
    run = load_run(out)
    assert run.info.conditions["load"] == {"unit": "N", "mean": 24.0, "min": 24.0, "max": 24.0}
    assert run.info.conditions["stress"]["mean"] == pytest.approx(24 / SECTION_MM2)
    assert load_of_run(run).force_N == 24.0
    assert run.info.rig_values["load"]["force_N"] == 24.0


def test_a_load_that_is_not_plausible_during_the_run_starts_nothing(tmp_path):
    out = tmp_path / "a.run.sqlite"
    with Session(RIG, load="20 - t/100") as session, pytest.raises(UsageError, match="only pulls"):
        session.run("isothermal_loading", {"input_K": 0.0, "duration_s": 3000.0}, out)
    assert not out.exists()


def test_simulated_devices_have_the_load_of_the_command(tmp_path):
    bench = tmp_path / "bench.toml"
    bench.write_text(
        'name = "bench"\nbase = "one_wire_serial"\nactuator = "thermomechanical_one_wire"\n'
        "[limits]\ncurrent_max_A = 0.75\ntemperature_max_K = 105.0\n"
    )
    settings = {"input_K": 0.0, "lead_s": 5.0, "duration_s": 60.0, "points": 6}
    found = []
    for rig in (RIG, str(bench)):
        with Session(rig, seed=2, load="20+min(t,60)/10", wire=f"loaded {rig[-5:]}") as session:
            found.append(
                load_run(session.run("isothermal_loading", settings, tmp_path / f"{len(found)}.run.sqlite"))
            )
    assert np.array_equal(found[0]["counts"], found[1]["counts"])
    assert np.ptp(found[0]["counts"]) > 20, "it moves"


def test_a_run_under_a_load_that_changes_is_not_resumed(tmp_path):
    out = tmp_path / "a.run.sqlite"
    settings = {"input_K": 0.0, "lead_s": 5.0, "duration_s": 60.0, "points": 6}

    class Stop:
        def sample(self, s, _step, _input_K):
            if s.t_s > 20:
                raise Interrupted("stopped by the test")

        def step(self, *_args, **_kwargs):
            pass

        def event(self, *_args, **_kwargs):
            pass

    with Session(RIG, load="20+t/100") as session, pytest.raises(Interrupted):
        session.run("isothermal_loading", settings, out, listeners=[Stop()])
    with pytest.raises(UsageError, match="changes over time"):
        resume(out)


@pytest.mark.long("takes three seconds")
def test_the_stress_strain_loop_has_the_critical_stresses_of_brinson(tmp_path):
    """Superelastic, in a chamber: forward from 410 to 634 MPa, back from 312 to 96 MPa."""
    rig = tmp_path / "chamber.toml"
    rig.write_text(
        f'name = "chamber"\nbase = "{RIG}"\nkind = "twin"\nactuator = "thermomechanical_one_wire"\n'
        f"ambient_degC = {CHAMBER_DEGC}\n"
    )
    settings = {"input_K": 0.0, "lead_s": 30.0, "duration_s": 3600.0, "points": 180}
    with Session(str(rig), seed=1, load="2+45*(1-abs(1-max(min((t-30)/1800,2),0)))") as session:
        run = load_run(session.run("isothermal_loading", settings, tmp_path / "loop.run.sqlite"))
    curve, m = stress_strain(run), Material.of(Actuator.named("thermomechanical_one_wire").file)
    strain = curve.strain + m.strain(float(curve.stress_MPa[0]), CHAMBER_DEGC, 0.0, 0.0)
    error = isothermal_loop(m, CHAMBER_DEGC, strain) - curve.stress_MPa
    # latent heat warms and cools the wire by half a kelvin at this rate: 4 MPa
    assert np.sqrt(np.mean(error**2)) < 2.5
    assert np.abs(error).max() < 6.0
    assert run.info.conditions["stress"]["max"] == pytest.approx(47 / SECTION_MM2, rel=1e-3)
    top = int(np.argmax(curve.stress_MPa))
    forward, back = (_ends(m, curve.stress_MPa[k], strain[k]) for k in (slice(0, top), slice(top, None)))
    assert forward == pytest.approx((410.0, 634.0), abs=6.0)
    assert back == pytest.approx((96.0, 312.0), abs=6.0)


def _ends(m, stress, strain):
    """The stresses without and with all martensite, from the cosine law: arccos(1 − 2ξ)/π is linear in σ.

    ξ solves ε = σ/E(ξ) + ε_L ξ + α(ξ) ΔT, by a table of strains of ξ.
    """
    grid = np.linspace(-0.05, 1.05, 1101)
    fraction = np.array(
        [np.interp(e, [m.strain(s, CHAMBER_DEGC, x, x) for x in grid], grid) for s, e in zip(stress, strain)]
    )
    inside = (fraction > 0.05) & (fraction < 0.95)
    slope, start = np.polyfit(np.arccos(1 - 2 * fraction[inside]) / np.pi, stress[inside], 1)
    return start, start + slope


def test_a_run_without_a_changing_load_has_no_stress_strain_curve(tmp_path, capsys):
    out = tmp_path / "a.run.sqlite"
    args = ["--rig", RIG, "--set", "points=10", "--set", "duration_s=20", "--set", "lead_s=2", "-o", str(out)]
    assert cli(["run", "isothermal_loading", *args, "--quiet", "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["runs"][0]["steps"] == 11
    with pytest.raises(Exception, match="no stress–strain curve"):
        stress_strain(load_run(out))
