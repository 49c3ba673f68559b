"""The meaning of columns is guessed as their owners state it, in several languages, and doubts are questions."""

from types import SimpleNamespace

import numpy as np
import pytest

from smarig.diagnosis.comparison.compared_hypothesis import Part
from smarig.diagnosis.comparison.measured.measured_comparison import RunOffset
from smarig.diagnosis.comparison.verdict_rules import Verdict
from smarig.exchange import FoundColumn, FoundTable, find_tables, load_mapping
from smarig.study import candidate_models, guess_table, mapping_draft, study_sentences
from smarig.study.study_sentences import finding_sentence
from study.known_data import displacements, temperatures

U = temperatures()
X = displacements(U)
T = np.arange(U.size) * 0.5
H = 400 * np.cos(np.linspace(0, 6 * np.pi, U.size))


def table(tmp_path, **columns) -> FoundTable:
    found = tuple(FoundColumn(name, "", np.asarray(values, dtype=float)) for name, values in columns.items())
    return FoundTable(tmp_path / "data.csv", "csv", "", found, {"file": {"delimiter": "comma"}}, {})


CASES = {  # columns, then the input, output and time with their units
    "english": ({"time [s]": T, "wire temperature [K]": U + 273, "stroke [um]": 1e3 * X}, "K", "um"),
    "german": ({"Zeit [ms]": 1e3 * T, "Temperatur [°C]": U, "Weg [mm]": X}, "degC", "mm"),
    "french": ({"temps (s)": T, "température (°C)": U, "déplacement (mm)": X}, "degC", "mm"),
    "letters": ({"t/s": T, "T/°C": U, "ε/%": X}, "degC", "%"),
    "units after an underscore": ({"time_s": T, "temp_degC": U, "displacement_mm": X}, "degC", "mm"),
    "no units": ({"Time": T, "Temperature": U, "Strain": -0.01 * X}, "degC", "mm/mm"),
    "strain in %": ({"Time": T, "Temperature": U, "Strain": X}, "degC", "%"),
    "hysteresis of a magnet": ({"H (Oe)": H, "M (emu)": np.tanh(H / 90)}, "Oe", "emu"),
    "flux": ({"H [A/m]": H, "B [T]": np.tanh(H / 90)}, "A/m", "T"),
    "ferroelectric": (
        {"Time [s]": T, "V [V]": H, "I [A]": 1e-5 * H, "P [uC/cm2]": 20 * np.tanh(H / 90)},
        "V",
        "uC/cm^2",
    ),
    "magnet, units with per": ({"t_s": T, "H_kA_per_m": H, "M_kA_per_m": np.tanh(H / 90)}, "kA/m", "kA/m"),
    "ferroelectric, units with per": (
        {"time_s": T, "E_kV_per_cm": H / 10, "P_uC_per_cm2": 20 * np.tanh(H / 90)},
        "kV/cm",
        "uC/cm^2",
    ),
    "stress, units with per": ({"t_s": T, "T_degC": U, "stress_N_per_mm2": 40 * X}, "degC", "MPa"),
    "piezo": ({"voltage (V)": H, "displacement (um)": np.tanh(H / 90)}, "V", "um"),
}


@pytest.mark.parametrize("name", CASES)
def test_columns_are_understood(tmp_path, name):
    columns, input_unit, output_unit = CASES[name]
    guess = guess_table(table(tmp_path, **columns))
    names = list(columns)
    drive, out = guess.first("input"), guess.first("output")
    assert drive is not None
    assert out is not None
    with_time = len(names) > 2
    assert drive.name == names[int(with_time)]
    assert out.name == names[-1]
    assert (drive.unit, out.unit) == (input_unit, output_unit)
    assert [c.name for c in guess.of_role("time")] == names[: int(with_time)]
    assert not guess.doubts
    path = tmp_path / "m.toml"
    path.write_text(mapping_draft(guess, "m"), encoding="utf-8")
    mapping = load_mapping(str(path))
    assert mapping.tables()[0][1][mapping.input.channel].column == drive.name


@pytest.mark.parametrize(
    ("name", "unit"),
    [
        ("heat_flow_W_per_g", "W/g"),
        ("slope MPa per K", "MPa/K"),
        ("wire_speed_mm_per_s", "mm/s"),
        ("m_A_m2_per_kg", "A m^2/kg"),
        ("E (V per um)", "V/um"),
        ("eps_um_per_m", "ppm"),
    ],
)
def test_a_unit_written_with_per_keeps_its_prefix(tmp_path, name, unit):
    (column,) = (c for c in guess_table(table(tmp_path, T_K=U + 273, **{name: X})).columns if c.name == name)
    assert column.unit == unit


@pytest.mark.parametrize("name", ["cycles_per_s", "H_per_m", "upper_m", "mm_per_step"])
def test_per_between_other_words_is_no_unit(tmp_path, name):
    (column,) = (c for c in guess_table(table(tmp_path, T_K=U + 273, **{name: X})).columns if c.name == name)
    assert "/" not in column.unit


def test_a_rate_of_a_temperature_is_no_clock(tmp_path):
    guess = guess_table(table(tmp_path, T_K=U + 273, T_K_per_min=np.gradient(U), **{"stroke [mm]": X}))
    assert guess.first("time") is None
    assert guess.first("output").name == "stroke [mm]"


def test_columns_without_any_sense_are_doubts(tmp_path):
    rng = np.random.default_rng(0)
    guess = guess_table(table(tmp_path, foo=rng.normal(1e5, 1e4, 50), bar=rng.normal(1e5, 1e4, 50)))
    assert "input" in guess.doubts
    assert "output" in guess.doubts
    told = guess_table(
        table(tmp_path, foo=H, bar=H**3), input="foo", output="bar", units={"foo": "A/m", "bar": "T"}
    )
    assert not told.doubts


def test_the_scatter_of_a_reading_is_no_output(tmp_path):
    scatter = 1e-7 * (1 + np.sin(T))
    columns = {
        "Temperature (K)": U + 273,
        "Long Scan Std Dev": scatter,
        "Long Percent Error (%)": 1e6 * scatter,
        "Long Moment (emu)": -1e-6 * X,
        "M. Std. Err. (emu)": scatter,
    }
    guess = guess_table(table(tmp_path, **columns))
    assert guess.first("output").name == "Long Moment (emu)"
    assert "error of a reading" in guess.roles["M. Std. Err. (emu)"].reason


def test_a_stated_output_counts_more_than_one_that_looks_like_a_strain(tmp_path):
    guess = guess_table(table(tmp_path, Temperature=U, foo=1e-3 * np.sin(T), **{"stroke [mm]": X}))
    assert guess.first("output").name == "stroke [mm]"


def test_a_constant_stress_is_a_condition_and_a_noisy_one_too(tmp_path):
    stress = 150 + np.random.default_rng(1).normal(0, 8, U.size)
    guess = guess_table(table(tmp_path, Temperature=U, Strain=-0.01 * X, Stress=stress))
    assert [c.name for c in guess.of_role("condition")] == ["Stress"]
    assert guess.scale == 1.0
    assert "falls" in guess.sign


def test_a_force_that_falls_when_a_clamped_wire_heats_is_turned(tmp_path):
    guess = guess_table(table(tmp_path, temperature=U, force=np.round(800 - 20 * X)))
    assert guess.scale == -1.0


def test_readings_beside_a_commanded_staircase_are_settled_points(tmp_path):
    command = np.round(np.arange(41) * 0.02, 6)
    guess = guess_table(
        table(
            tmp_path,
            **{
                "I set [A]": command,
                "I meas [A]": command + 0.003 * np.sin(command * 40),
                "x [mm]": command**3,
            },
        )
    )
    assert guess.settled
    assert guess.first("input").name == "I meas [A]"
    assert guess.first("command").name == "I set [A]"


# Roles as the mapping files that ship with smarig state them: (file, mapping, what differs and why).
REAL = [
    ("sma_staircase/test.csv", "sma_staircase", ()),
    ("sma_isobaric/cal_sample_1/150 MPa.txt", "sma_isobaric_1", ()),
    ("sma_isobaric/cal_sample_2/200 MPa.txt", "sma_isobaric_2", ()),
    ("flexinol_isobaric/filtered_data_100MPa.txt", "flexinol_isobaric", ()),
    ("sma_cycles/cycles.txt", "sma_cycles", ()),
    ("sma_force_runs/AB5_thin.csv", "sma_force_runs", ()),
    ("sma_heating_step/step.csv", "sma_heating_step", ()),
    ("sma_nested_bumps/ele_hys_1.txt", "sma_nested_bumps", ("time",)),  # its source states the period
    ("sma_water_steps/hyd_stp_2.txt", "sma_water_steps", ("time",)),
    (
        "sma_chamber/chamber_100MPa.csv",
        "sma_chamber",
        ("output",),
    ),  # the strain column, not the crosshead in inches
    ("ferrite_nested/H_MnZn_HP_ferrite.mat", "ferrite_nested", ()),
]


@pytest.mark.parametrize(("file", "mapping", "differs"), REAL, ids=lambda v: str(v).split("/")[0])
def test_real_files_are_understood_as_their_mapping_files_state(shared_data, file, mapping, differs):
    found = max(find_tables(shared_data / file), key=len)
    guess, stated = guess_table(found), load_mapping(mapping)
    assert not guess.doubts
    columns = stated.tables()[0][1]
    place = {name: k for k, name in enumerate(stated.file.names)}  # files without a header

    def at(name):
        return found.names[place[name]] if place else name

    drive = columns[stated.input.channel]
    assert guess.first("input").name == at(drive.column)
    assert guess.first("input").unit == drive.unit
    if "output" not in differs and stated.output is not None:
        position = columns["position"]
        assert guess.first("output").name == at(position.column)
        assert guess.first("output").unit == position.unit
        assert np.sign(guess.scale) == np.sign(position.scale)
    if "time" not in differs:
        named = stated.time.column if stated.time else ""
        assert [c.name for c in guess.of_role("time")] == ([named] if named else [])


@pytest.mark.parametrize("jump_K", [25.0, 2.0])
def test_of_two_thermometers_it_is_told_that_the_first_jumps(tmp_path, jump_K):
    rear = np.concatenate([np.linspace(25, 85, 100), np.linspace(85, 25, 100)])
    front = rear + 0.2
    front[40:60] -= jump_K
    y = 9 * (1 + np.tanh((rear - 60) / 6))
    guess = guess_table(
        table(tmp_path, **{"temperature front": front, "temperature rear": rear, "displacement": y})
    )
    assert guess.first("input").name == "temperature front"
    told = "'temperature front' jumps by up to 25.6 from row to row, this one by 0.606: try it as the input"
    assert (told in guess.roles["temperature rear"].reason) == (jump_K == 25.0)


def test_columns_of_a_second_branch_are_shown_with_the_role_of_the_first(tmp_path):
    up = np.linspace(0, 1, 30)
    columns = {"current1 [A]": up, "current2 [A]": up[::-1], "stroke1 [mm]": up**2, "stroke2 [mm]": up[::-1]}
    guess = guess_table(table(tmp_path, **columns, other=up**3))
    assert [guess.shown_role(name).role for name in columns] == [
        "input",
        "input, second branch",
        "output",
        "output, second branch",
    ]
    assert "'stroke1 [mm]'" in guess.shown_role("stroke2 [mm]").reason
    assert guess.shown_role("other") == guess.roles["other"]


@pytest.mark.parametrize("variable", ["time", None])
def test_a_learned_term_is_told_beside_what_no_effect_explains(variable):
    def sentence(learned):
        d = SimpleNamespace(
            verdict=SimpleNamespace(word="unknown", depends_on=variable, names=()),
            learned=learned,
            lines=lambda: ["-"],
        )
        return finding_sentence(d, at_noise=False)

    assert sentence(None).endswith("no known effect explains them.")
    assert sentence(object()).endswith(
        "explains them; a term learned from them describes a part, without a cause."
    )


def test_errors_that_a_good_model_leaves_are_small():
    verdict = SimpleNamespace(word="unknown", depends_on="time", names=())
    d = SimpleNamespace(verdict=verdict, learned=None, lines=lambda: ["-"])
    said = finding_sentence(d, at_noise=False, small=True)
    assert said.startswith("The errors that are left are small and vary with the time;")


def test_of_several_shifted_runs_the_held_out_one_is_told(monkeypatch):
    monkeypatch.setattr(study_sentences, "MeasuredDiagnosis", SimpleNamespace)
    offsets = [
        RunOffset(run, offset, (offset, offset), 0.2, 0.1, "first", held_out)
        for run, offset, held_out in (("weak", 1.0, True), ("strong", -2.0, True), ("fitted", 9.0, False))
    ]
    d = SimpleNamespace(
        verdict=SimpleNamespace(word="named", depends_on=None, names=("input_offset",)),
        offsets=offsets,
        runs=[SimpleNamespace(input_unit="degC")],
        unit="mm",
    )
    assert finding_sentence(d, at_noise=False).startswith(
        "The loop of held-out run strong is shifted by 2 [2, 2] °C"
    )


SHIFTS = {
    "one that may be 0": [(-4.9, 0.02)],
    "sure": [(-4.9, -3.1)],
    "one of two": [(-0.3, 0.2), (2.1, 2.4)],
}


@pytest.mark.parametrize("shifts", SHIFTS)
def test_an_effect_whose_strength_may_be_0_is_a_possible_cause(monkeypatch, shifts):
    parameters = {
        f"run {k}": {"value": sum(ends) / 2, "ci95": list(ends), "unit": "N"}
        for k, ends in enumerate(SHIFTS[shifts])
    }
    kind = SimpleNamespace(name="input_offset", summary="The loops of runs are shifted.")
    monkeypatch.setattr(study_sentences, "MeasuredDiagnosis", SimpleNamespace)
    d = SimpleNamespace(
        verdict=SimpleNamespace(word="named", depends_on="", names=("drift",)),
        best=SimpleNamespace(effects=[SimpleNamespace(kind=kind)]),
        effects=lambda: [{"name": "input_offset", "parameters": parameters}],
        offsets=(),
        lines=lambda: ["-"],
    )
    said = finding_sentence(d, at_noise=False)
    if shifts == "one that may be 0":
        possible = "A possible cause: input_offset (the loops of runs are shifted): "
        assert said.startswith(possible)
        assert said.endswith("(−4.9 to 0.02), which may be 0.")
    else:
        assert said.startswith("A cause was found: input_offset. The loops of runs are shifted. ")


def test_a_cause_that_the_design_confounds_is_told_with_the_reason_and_not_denied():
    """A lag is certain, but the rate rises with time in these data."""
    lag = Part("effect", "input_lag")
    verdict = Verdict("unknown", "confounded", ("input_lag",), "time")
    d = SimpleNamespace(verdict=verdict, causes={lag: 0.97}, learned=object(), lines=lambda: ["-"])
    assert finding_sentence(d, at_noise=False) == (
        "The errors that are left vary with the time. The likeliest cause: input_lag (0.97). In these data the cause "
        "varies together with others."
    )


def test_the_extended_model_has_a_zero_of_its_own_for_each_fitted_run(monkeypatch):
    """As the diagnosis has; the runs that are held out are judged as for any other model."""
    asked = {}

    def verify(model, runs, offset="auto"):
        asked[tuple(runs)] = offset
        return SimpleNamespace(runs=[SimpleNamespace(settled=SimpleNamespace(n=1, rms=1.0))])

    monkeypatch.setattr(candidate_models, "verify", verify)
    split = SimpleNamespace(train=("a",), held_out=("b",), select=None, continued=False, kind="run")
    model = SimpleNamespace(warnings=())
    first = candidate_models.CandidateModel("plain", model, (), (), verify(model, ("c",)).runs)
    candidate_models.with_diagnosed(
        candidate_models.Evaluation((first,), {}, {}), candidate_models.EXTENDED, model, split
    )
    assert (asked["a",], asked["b",]) == ("fitted", "auto")


@pytest.mark.parametrize(("unit", "taken"), [("mil", "mil"), ("thou", "mil"), ("furlong", "mm")])
def test_a_unit_that_is_stated_but_unknown_is_told_as_assumed(tmp_path, unit, taken):
    columns = {"time [s]": T, "temperature [degC]": U, f"position [{unit}]": X}
    position = guess_table(table(tmp_path, **columns)).columns[-1]
    assert position.unit == taken
    assert ("which is unknown; taken as mm" in position.unit_reason) == (taken == "mm")


OHMS = {"mOhm": "mohm", "uOhm": "uohm", "µOhm": "uohm", "kOhm": "kohm", "KOhm": "kohm", "MOhm": "Mohm"}
OHMS |= {"mOhms": "mohm", "Ohm": "ohm", "OHM": "ohm", "mΩ": "mohm", "µΩ": "uohm"}


@pytest.mark.parametrize("written", OHMS)
@pytest.mark.parametrize("name", ["R_{}", "R/{}", "R ({})", "R [{}]", "R4w_{}", "R in {}"])
def test_ohms_with_a_prefix_are_resistances(tmp_path, name, written):
    columns = {"t/s": T, "T/K": U + 273, name.format(written): 610 + X}
    out = guess_table(table(tmp_path, **columns)).first("output")
    assert out is not None
    assert (out.quantity, out.unit) == ("resistance", OHMS[written])


@pytest.mark.parametrize("name", ["R_mFoo", "Foo", "stroke [furlong]", "pos (smoots)", "A3"])
def test_a_unit_that_is_not_known_is_a_question(tmp_path, name):
    columns = {"time [s]": T, "temperature [degC]": U, name: X}
    guess = guess_table(table(tmp_path, **columns))
    assert guess.doubts == [f"unit {name}"]
    given = guess_table(table(tmp_path, **columns), units={name: "um"})
    assert not given.doubts


@pytest.mark.parametrize("name", ["x", "pos", "displacement", "Weg"])
def test_a_displacement_without_a_unit_is_assumed(tmp_path, name):
    guess = guess_table(table(tmp_path, **{"time [s]": T, "temperature [degC]": U, name: X}))
    out = guess.first("output")
    assert out is not None
    assert not guess.doubts
    assert out.unit == "mm"
    assert out.unit_is_assumed


@pytest.mark.parametrize(("unit", "quantity"), [("mohm", "resistance"), ("uV", "voltage"), ("MPa", "stress")])
@pytest.mark.parametrize("name", ["R_mFoo", "Foo", "x"])
def test_the_quantity_follows_the_unit_of_the_user(tmp_path, name, unit, quantity):
    columns = {"time [s]": T, "temperature [degC]": U, name: X}
    guess = guess_table(table(tmp_path, **columns), output=name, units={name: unit})
    out = guess.first("output")
    assert out is not None
    assert (out.quantity, out.unit) == (quantity, unit)
    assert "displacement" not in out.quantity_reason


@pytest.mark.parametrize(
    ("name", "is_stress"),
    [("Pressure (Torr)", False), ("Druck [mbar]", False), ("chamber (Torr)", False)]
    + [("stress (MPa)", True), ("Druckspannung (bar)", True), ("(MPa)", True)],
)
def test_the_pressure_of_a_gas_is_no_stress(tmp_path, name, is_stress):
    columns = {"t (s)": T, "T (K)": U + 273, "x (mm)": X, name: 5.09 + 0.01 * np.sin(T)}
    guess = guess_table(table(tmp_path, **columns))
    assert guess.roles[name].role == ("condition" if is_stress else "ignored")
    assert ("[conditions]" in mapping_draft(guess, "m")) == is_stress


@pytest.mark.parametrize("name", ["Indice", "Ilfd", "Uid"])
def test_a_word_with_the_letter_of_a_current_counts_rows(tmp_path, name):
    columns = {name: np.arange(U.size) + 1, "t [s]": T, "T [°C]": U, "stroke [mm]": X}
    guess = guess_table(table(tmp_path, **columns))
    assert [c.name for c in guess.of_role("input")] == ["T [°C]"]
    assert next(c.quantity for c in guess.columns if c.name == name) == "row number"
