"""A study of curves of heat flow: no model, six temperatures, and the direction of the peaks."""

import json
import re

import numpy as np
import pytest

from smarig.core import UsageError
from smarig.study import StudyOptions, study
from smarig.study.heat_flow_header import HeatFlowHeader, exothermic_direction, heat_flow_header
from smarig.study.understanding import understand
from transformation.known_peaks import KnownPeak

pytestmark = pytest.mark.usefixtures("drawings")
RATE_K_PER_MIN = 10.0
HEATING = KnownPeak(middle=55.0, before=4.0, after=4.0, height=0.6, slope=2e-4)
COOLING = KnownPeak(middle=25.0, before=5.0, after=5.0, height=0.5)
FIELD_CASE = "field_cases/dsc_heat_flow/dsc.txt"


def branches(cycles=1, endothermic=1.0, seed=0, hold=0):
    """(temperature, minutes, heat flow) of branches one after the other; endothermic up if +1."""
    rng, t, found = np.random.default_rng(seed), 0.0, []
    up = np.arange(-60.0, 110.0, 0.25)
    for cycle in range(cycles):
        for u, y in (
            (up, KnownPeak(**{**vars(HEATING), "middle": 55.0 + cycle}).heat_flow(up)),
            (up[::-1], -COOLING.heat_flow(up[::-1])),
        ):
            held = np.full(hold, u[-1])
            u, y = np.append(u, held), np.append(y, np.zeros(hold))
            minutes = t + np.arange(u.size) * 0.25 / RATE_K_PER_MIN
            found.append((u, minutes, endothermic * y + 0.003 * rng.standard_normal(u.size)))
            t = minutes[-1] + 0.25 / RATE_K_PER_MIN
    return found


def trios(path, tables, header="Exotherm Direction\tUp\n"):
    """A text export of TRIOS: a table for each step, with a row of names and a row of units."""
    text = f"Filename\tx.tri\nSample Mass\t8.1 mg\n{header}"
    for u, t, q in tables:
        rows = "".join(f"{a:.4f}\t{b:.3f}\t{c:.5f}\n" for a, b, c in zip(t, u, q))
        text += f"\n[step]\nRamp to {u[-1]:.0f} °C\nTime\tTemperature\tHeat Flow\nmin\t°C\tW/g\n{rows}"
    path.write_text(text, encoding="utf-8")
    return path


def proteus(path, tables, unit="mW/mg"):
    """A text export of NETZSCH Proteus: lines with #, names with units behind a sign, one table."""
    text = "#EXPORTTYPE:;DATA ALL\n#FORMAT:;NETZSCH5\n#SEPARATOR:;SEMICOLON\n#SAMPLE MASS /mg:;10.0\n#EXO:;-1\n\n"
    text += f"##Temp./°C;Time/min;DSC/({unit})\n"
    for u, t, q in tables:
        text += "".join(f"{a:.3f};{b:.4f};{c:.5f}\n" for a, b, c in zip(u, t, q))
    path.write_text(text, encoding="latin-1")
    return path


def check(cycle, shift=0.0):
    """The figures of a cycle against those of the known peaks."""
    known = {"A_s": HEATING.feet[0] + shift, "A_p": HEATING.middle + shift, "A_f": HEATING.feet[1] + shift}
    known |= {"M_s": COOLING.feet[1], "M_p": COOLING.middle, "M_f": COOLING.feet[0]}
    known |= {"heating_heat": HEATING.area * 6, "cooling_heat": COOLING.area * 6}  # 6 s/K
    assert cycle.figures.keys() == known.keys()
    for name, value in known.items():
        low, high = cycle.figures[name].ci95
        assert low - 0.3 <= value <= high + 0.3, name
        assert high - low < 3.0, name


def test_an_export_in_spanish_gives_mass_direction_and_the_temperature_of_the_sample(tmp_path):
    (up, t1, q1), (down, t2, q2) = branches()
    u, t, q = np.concatenate([up, down]), 60 * np.concatenate([t1, t2]), 8 * np.concatenate([q1, q2])
    lines = [
        "Ensayo: alambre 7",
        "Masa de referencia (mg): 3,0",
        "Masa (g): 0,008",
        "Exotérmico: hacia abajo",
        "",
    ]
    lines.append("Índice;Tiempo (s);Temperatura horno (°C);Temperatura muestra (°C);Flujo de calor (mW)")
    lines += [f"{k};{a:.2f};{b + 1.5:.3f};{b:.3f};{c:.4f}" for k, (a, b, c) in enumerate(zip(t, u, q))]
    path = tmp_path / "a.txt"
    path.write_text("\n".join(lines).replace(".", ",") + "\n", encoding="cp1252")
    guess = understand([path], StudyOptions()).guesses[0]
    roles = {c.name: guess.roles[c.name].role for c in guess.columns}
    assert roles["Temperatura muestra (°C)"] == "input"
    assert (roles["Índice"], roles["Flujo de calor (mW)"]) == ("ignored", "output")
    assert heat_flow_header(guess.table) == HeatFlowHeader("down", 8.0)


@pytest.mark.parametrize("endothermic", [1.0, -1.0])
def test_an_export_of_trios_gives_six_temperatures_and_no_model(tmp_path, endothermic):
    way = "Down" if endothermic > 0 else "Up"
    file = trios(tmp_path / "a.txt", branches(endothermic=endothermic), f"Exotherm Direction\t{way}\n")
    result = study([file], tmp_path / "out", StudyOptions())
    assert [c.name for c in result.understood.guesses[0].columns] == ["Time", "Temperature", "Heat Flow"]
    assert (result.evaluation, result.diagnosis, result.verdict) == (None, None, "")
    assert result.unit == "W/g"
    assert "is a rate" in result.sentences()[0]
    assert result.sentences()[-1] == f"Exothermic is {way.lower()}, as the file says."
    check(result.calorimetry.cycles[0])
    assert not (tmp_path / "out" / "model.json").exists()


@pytest.mark.long("one of many cases", but_first=True)
@pytest.mark.parametrize("endothermic", [1.0, -1.0])
def test_an_export_of_proteus_with_two_cycles_and_holds_gives_a_row_for_each(tmp_path, endothermic):
    file = proteus(tmp_path / "b.csv", branches(2, endothermic, hold=80))
    result = study([file], tmp_path / "out", StudyOptions())
    found = result.calorimetry
    assert [c.number for c in found.cycles] == [1, 2]
    for k, cycle in enumerate(found.cycles):
        check(cycle, float(k))
    assert (found.stated, found.exothermic) == (False, "down" if endothermic > 0 else "up")
    page = (tmp_path / "out" / "index.html").read_text(encoding="utf-8")
    first = page[page.index("<main>") : page.index('id="section-2"')]
    assert len(re.findall("<tr>", first)) == 3, "a header and a row for each cycle"
    assert f"exothermic {found.exothermic}" in first
    stored = json.loads((tmp_path / "out" / "study.json").read_text(encoding="utf-8"))["calorimetry"]
    assert stored["cycles"][1]["figures"]["A_p"]["value"] == pytest.approx(56.0, abs=0.3)


def test_milliwatts_give_heat_per_gram_with_the_mass_of_the_file(tmp_path):
    tables = [(u, t, 10.0 * q) for u, t, q in branches()]  # 10 mg
    result = study([proteus(tmp_path / "c.csv", tables, "mW")], tmp_path / "out", StudyOptions())
    assert result.calorimetry.heat_unit == "J/g"
    check(result.calorimetry.cycles[0])


def test_a_second_peak_is_named_and_only_the_other_branch_has_temperatures(tmp_path):
    (heating, (u, t, q)) = branches()
    second = q - 0.3 * np.exp(-(((u + 10.0) / 6.0) ** 2) / 2)
    result = study([proteus(tmp_path / "r.csv", [heating, (u, t, second)])], tmp_path / "out", StudyOptions())
    (cycle,) = result.calorimetry.cycles
    assert {"A_s", "A_p", "A_f"} <= cycle.figures.keys()
    assert "M_s" not in cycle.figures
    assert any("No M_s" in s and "second peak, as that of an R-phase" in s for s in result.sentences())


@pytest.mark.parametrize(("middle", "narrow"), [(51.0, True), (31.0, False)])
def test_peaks_that_overlap_may_be_those_of_an_r_phase(tmp_path, middle, narrow):
    (heating, (u, t, _)) = branches()
    noise = 0.003 * np.random.default_rng(6).standard_normal(u.size)
    cooling = noise - KnownPeak(middle=middle, before=5.0, after=5.0, height=0.5).heat_flow(u)
    result = study(
        [proteus(tmp_path / "r.csv", [heating, (u, t, cooling)])], tmp_path / "out", StudyOptions()
    )
    assert any("M_s and M_f may be its R_s and R_f" in s for s in result.sentences()) is narrow


def test_a_curve_without_peaks_says_so(tmp_path):
    flat = [
        (u, t, 0.003 * np.random.default_rng(k).standard_normal(u.size))
        for k, (u, t, _) in enumerate(branches())
    ]
    result = study([trios(tmp_path / "f.txt", flat)], tmp_path / "out", StudyOptions())
    assert result.sentences()[1] == "No transformation temperatures."
    assert not any("Exothermic" in s for s in result.sentences())


def test_a_direction_that_contradicts_the_peaks_is_named(tmp_path):
    file = trios(tmp_path / "d.txt", branches(endothermic=1.0), "exothermic\tup\n")
    result = study([file], tmp_path / "out", StudyOptions())
    assert "points the other way" in result.sentences()[-1]


def test_a_heat_flow_without_a_temperature_is_refused(tmp_path):
    path = tmp_path / "e.csv"
    rows = "\n".join(f"{k / 10},{np.sin(k / 9):.4f},{np.cos(k / 9):.4f}" for k in range(200))
    path.write_text(f"time (s),field (mT),heat flow (W/g)\n{rows}\n", encoding="utf-8")
    with pytest.raises(UsageError, match="rate"):
        study([path], tmp_path / "out", StudyOptions(input="field (mT)", output="heat flow (W/g)"))


@pytest.mark.parametrize(
    ("line", "way"),
    [
        ("exothermic\tUp", "up"),
        ("Exotherm Direction: Down", "down"),
        ("Heat Flow (Endo Up) [mW]", "down"),
        ("DSC (↑ exo)", "up"),
        ("^exo", "up"),
        ("#EXO:;-1", ""),
        ("exotic update", ""),
    ],
)
def test_the_direction_is_read_where_words_say_it(line, way):
    assert exothermic_direction(["Filename\tx", line]) == way


def test_the_field_case_has_its_peaks_where_they_were_made(shared_data, tmp_path):
    if not (shared_data / FIELD_CASE).is_file():
        pytest.skip(f"{FIELD_CASE} is not in {shared_data}")
    (cycle,) = study([shared_data / FIELD_CASE], tmp_path / "out", StudyOptions()).calorimetry.cycles
    assert cycle.figures["A_p"].value == pytest.approx(62.0, abs=0.3)
    assert cycle.figures["M_p"].value == pytest.approx(28.0, abs=0.3)


@pytest.mark.long("one of each kind", one_of_each=True)
@pytest.mark.parametrize("states", [True, False])
@pytest.mark.parametrize("above", [0.0, 30.0])
def test_a_power_is_a_heat_flow_where_it_turns_negative_or_a_way_is_exothermic(tmp_path, states, above):
    """As STARe writes it: units below the names, a footer, and "Value" in mW."""
    lines = [
        "Curve Values:",
        "   Index         t        Ts     Value",
        "               [s]      [°C]      [mW]",
    ]
    for u, t, q in branches(cycles=1, endothermic=-1.0):
        lines += [
            f"{len(lines):8d} {60 * b:10.2f} {a:9.4f} {10 * c + above:9.5f}" for b, a, c in zip(t, u, q)
        ]
    lines += ["Results:", "Sample:", "  wire 3, 10.1 mg", "  ^exo" if states else "  "]
    (tmp_path / "a.txt").write_text("\n".join(lines) + "\n", encoding="utf-8")
    (guess,) = understand([tmp_path / "a.txt"], StudyOptions(accept=True)).guesses
    out = guess.first("output")
    assert (out is not None and out.quantity == "heat flow") == (states or not above)
    if states:
        result = study([tmp_path / "a.txt"], tmp_path / "out", StudyOptions())
        assert result.unit == "mW"
        assert result.sentences()[-1] == "Exothermic is up, as the file says."
        assert {"A_s", "A_f", "M_s", "M_f"} <= result.calorimetry.cycles[0].figures.keys()


@pytest.mark.long("one of many cases", but_first=True)
@pytest.mark.parametrize("unit", ["mW", "W/g"])
def test_the_lag_of_the_instrument_after_a_turn_is_no_baseline_and_no_other_state(tmp_path, unit):
    """A sensor that follows the turn of a heat capacity in 8 s: the feet and the heat keep narrow intervals."""
    late = []
    for k, (u, t, y) in enumerate(branches(cycles=3, seed=4)):
        decay = np.exp(-(t - t[0]) / (8 / 60))
        capacity = -0.7 if k % 2 else 0.7
        late.append((u, t, y + capacity * (1 - (2 if k else 0) * decay)))
    table = [tuple(np.concatenate(parts)) for parts in zip(*late)]
    text = f"Time (min)\tTemperature (°C)\tHeat Flow ({unit})\n"
    text += "".join(f"{b:.4f}\t{a:.3f}\t{c:.5f}\n" for a, b, c in zip(*table))
    (tmp_path / "a.txt").write_text(text, encoding="utf-8")
    result = study([tmp_path / "a.txt"], tmp_path / "out", StudyOptions())
    for cycle in result.calorimetry.cycles:
        for name, low, high in (("A_s", 46, 51), ("M_s", 34, 36), ("M_f", 14, 16)):
            assert low < cycle.figures[name].value < high
            assert np.ptp(cycle.figures[name].ci95) < 1
        assert np.ptp(cycle.figures["cooling_heat"].ci95) < 0.2 * cycle.figures["cooling_heat"].value
    assert not any("another state" in hint for hint in result.hints())


@pytest.mark.parametrize(
    ("line", "mass"), [("Size\t7.250\tmg", 7.25), ("Sample size: 0,0091 g", 9.1), ("Size 12", None)]
)
def test_a_size_in_a_unit_of_mass_is_the_mass(tmp_path, line, mass):
    path = trios(tmp_path / "a.txt", branches(), header=f"{line}\n")
    path.write_text(path.read_text(encoding="utf-8").replace("Sample Mass\t8.1 mg\n", ""), encoding="utf-8")
    (guess, *_) = understand([path], StudyOptions()).guesses
    assert heat_flow_header(guess.table).mass_mg == (mass and pytest.approx(mass))
