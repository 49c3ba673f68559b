"""Temperature profiles T(t) of ``step_currents`` (§5.2.1): formulas and files of time, and what is refused."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import smarig
from protocols.test_every_protocol import targets
from smarig.core import DataError, Formula, UsageError
from smarig.protocols import Setup, build_protocol


def test_a_formula_is_sampled_at_even_times():
    got = targets(
        "step_currents", temperature="87+60*sin(2*pi*t/600)*exp(-t/1800)", duration_s="1200", points="41"
    )
    t = np.linspace(0.0, 1200.0, 41)
    assert got == pytest.approx(87 + 60 * np.sin(2 * np.pi * t / 600) * np.exp(-t / 1800), abs=1e-9)


def test_the_currents_are_those_of_the_heating_law():
    """§5.2.1: I_i = √(hA |T_i|/R) with the sign of T_i; on the two-wire rig 185 K at 1 A."""
    settings = {"temperature": "185*cos(pi*t/100)", "duration_s": 100, "points": 5}
    holds = [
        c
        for c in build_protocol("step_currents", Setup.of("two_wire_twin"), settings)
        if hasattr(c, "target")
    ]
    expected = [math.copysign(math.sqrt(abs(math.cos(x))), math.cos(x)) for x in np.linspace(0, math.pi, 5)]
    assert [h.current_A for h in holds] == pytest.approx(expected, abs=1e-6)


def test_a_file_of_time_is_interpolated(tmp_path):
    file = tmp_path / "profile.csv"
    file.write_text("time_s,temperature_K\n0,10\n100,110\n300,10\n")
    assert targets("step_currents", file=str(file), points=7) == pytest.approx([10, 60, 110, 85, 60, 35, 10])


@given(st.integers(0, 4), st.floats(-30, 30), st.floats(0.1, 5))
def test_formulas_have_the_value_of_the_same_python(which, t, c):
    text = [
        f"{c}*t**2 - 3*t/{c} + -(+t)",
        f"sin({c}*t) + cos(t)*tan(0.1*{c})",
        f"exp(-t/{c}/10) + sqrt(abs(t)) + e",
        f"min(t, {c}) + max(t, 2) * log({c} + t*t)",
        f"2**-{c} - (t - pi)*(t + 1e2)",
    ][which]
    allowed = {n: getattr(math, n) for n in ("sin", "cos", "tan", "exp", "log", "sqrt", "pi", "e")}
    expected = eval(text, {"__builtins__": {}}, allowed | {"abs": abs, "min": min, "max": max, "t": t})
    assert Formula(text)(t) == pytest.approx(expected, rel=1e-12, abs=1e-12)


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("__import__('os').system('true')", "calls something other"),
        ("t.real", "may contain only"),
        ("(lambda: 1)()", "calls something other"),
        ("[t for t in (1,2)]", "may contain only"),
        ("open", "contains 'open'"),
        ("'a'*9", "not a real number"),
        ("1j*t", "not a real number"),
        ("True", "not a real number"),
        ("t^2", r"written with \*\*"),
        ("t < 3", "may contain only"),
        ("sin(t, 2)", "wrong number of arguments"),
        ("sin(x=t)", "wrong number of arguments"),
        ("t +", "cannot be read; write a function of t"),
        ("a" * 600, "1 to 500 characters"),
        ("9" * 400, "too large"),
        ("(" * 249 + "t" + ")" * 249, "nested|cannot be read"),
    ],
)
def test_anything_else_is_refused_before_it_runs(text, says):
    with pytest.raises(UsageError, match=says) as caught:
        Formula(text)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("1/t", "divides by zero at t = 0"),
        ("sqrt(t-1)", "no finite value"),
        ("(t-1)**0.5", "no finite value"),
        ("exp(1e4+t)", "no finite value"),
        ("9**9**9**9", "no finite value"),
        ("1e300*1e300*(t+1)", "no finite value"),
    ],
)
def test_values_that_are_not_finite_name_their_time(text, says):
    with pytest.raises(UsageError, match=says):
        targets("step_currents", temperature=text, duration_s=10, points=3)


@pytest.mark.parametrize(
    ("settings", "says"),
    [
        ({"temperature": "60"}, "temperature and duration_s together"),
        ({"duration_s": 5}, "temperature and duration_s together"),
        ({"temperature": "60", "duration_s": -5}, "duration_s must be positive"),
        ({"temperature": "60", "duration_s": 5, "temperatures_K": "1,2"}, "only one of"),
        ({"temperature": "600", "duration_s": 5}, "outside the rig's range"),
    ],
)
def test_wrong_settings_of_a_profile(settings, says):
    with pytest.raises(UsageError, match=says):
        targets("step_currents", **settings)


@pytest.mark.parametrize(
    "text",
    [
        "time_s,current_A\n0,1\n",
        "time_s,temperature_K\n0,1\n0,2\n",
        "time_s,temperature_K\n0,1\n",
        "time_s,temperature_K\n0,1\n5\n",
        "time_s,temperature_K\n0,1\n5,nan\n",
    ],
)
def test_wrong_files_of_time(tmp_path, text):
    (tmp_path / "p.csv").write_text(text)
    with pytest.raises(DataError):
        targets("step_currents", file=str(tmp_path / "p.csv"))


def test_a_formula_runs_on_the_twin(tmp_path):
    run = smarig.run(
        "step_currents",
        rig="one_wire_twin",
        out=tmp_path / "p.run.sqlite",
        seed=1,
        temperature="50+40*sin(2*pi*t/60)",
        duration_s=60,
        points=5,
    )
    settled = [s.target for s in run.steps if s.verdict == "settled"]
    assert settled == pytest.approx([50, 90, 50, 10, 50], abs=1e-9)


@pytest.mark.parametrize("text", ["min(90, (10**308*10 - 10**308*10))", "max(1, tan(t)*10**308*10*0)"])
def test_what_is_no_number_is_not_hidden_by_a_minimum(text):
    with pytest.raises(UsageError, match="has no finite value"):
        Formula(text)(1.0)


def test_an_infinite_number_is_refused():
    with pytest.raises(UsageError, match="a number that is too large"):
        Formula("min(90, 1e400)")
