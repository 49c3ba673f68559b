"""From files to a page: what it writes can be read again, and says what the data say."""

import json
import re
from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from smarig.cli import run as cli
from smarig.core import DataError, UsageError
from smarig.record import load_run
from smarig.replay import load_model
from smarig.study import StudyOptions, study
from smarig.study.candidate_models import CandidateModel, Evaluation
from smarig.study.study_result import StudyResult
from study.known_data import csv_text, displacements, temperatures

QUICK = StudyOptions(diagnose=False)


@pytest.fixture
def files(tmp_path):
    """Three runs of one wire, as a European instrument writes them."""
    paths = []
    for k in range(3):
        u = temperatures(2 + k % 2, 60)
        path = tmp_path / f"tag {k}.csv"
        path.write_bytes(csv_text(np.arange(u.size) * 0.5, u, displacements(u, k)).encode("latin-1"))
        paths.append(path)
    return paths


def test_three_files_become_runs_a_model_and_a_page(files, tmp_path):
    out = tmp_path / "out"
    result = study(files, out, QUICK)
    assert result.verdict == "good"
    assert result.split.kind == "run"
    assert result.evaluation.best.rms < 0.04, "noise of 0.01 mm and a smooth density"
    assert result.gain > 3
    assert load_model(out / "model.json").unit == "mm"
    u = temperatures(2, 60)
    first = load_run(next(iter(sorted((out / "runs").glob("*.sqlite")))))
    np.testing.assert_allclose(first["input"], u, atol=6e-4)
    page = (out / "index.html").read_text(encoding="utf-8")
    for sentence in result.sentences():
        assert sentence.split("(")[0].strip() in page.replace("&#x27;", "'")
    assert json.loads((out / "study.json").read_text(encoding="utf-8"))["questions"] == 0


def test_the_drafted_mapping_imports_the_file_again(files, tmp_path):
    study(files[:1], tmp_path / "out", QUICK)
    again = tmp_path / "again.run.sqlite"
    mapping = str(tmp_path / "out" / "mapping.toml")
    assert cli(["import", str(files[0]), "--format", "csv", "--map", mapping, "-o", str(again)]) == 0
    (first,) = (tmp_path / "out" / "runs").glob("01_*[0-9].run.sqlite")
    np.testing.assert_array_equal(load_run(again)["position"], load_run(first)["position"])


def test_one_loop_is_not_compared_with_its_own_branches(tmp_path):
    u = temperatures(1, 120)
    path = tmp_path / "loop.csv"
    path.write_text(csv_text(np.arange(u.size) * 0.5, u, displacements(u)), encoding="utf-8")
    result = study([path], tmp_path / "out", QUICK)
    assert result.split.kind == "none"
    assert set(result.evaluation.simple) == {"straight line", "mean curve, no hysteresis"}
    assert result.verdict == "good"


@pytest.mark.long("takes two seconds")
def test_where_nothing_is_held_out_the_error_on_blocks_left_out_is_said_too(tmp_path):
    u = temperatures(1, 120)
    noise = np.random.default_rng(4).normal(0.0, 0.02, u.size)
    path = tmp_path / "loop.csv"
    path.write_text(csv_text(np.arange(u.size) * 0.5, u, displacements(u) + noise), encoding="utf-8")
    result = study([path], tmp_path / "out", StudyOptions())
    found = result.diagnosis.best or result.diagnosis.base
    stated = re.search(r"On blocks left out of the fit, the error is ([\d.]+) mm rms", result.sentences()[0])
    assert stated is not None
    assert float(stated[1]) == pytest.approx(found.rms, rel=0.01)


def with_fits(diagnosis, base, best):
    """The diagnosis with other fits of the plain and the extended model."""
    extension = best and SimpleNamespace(hypothesis=best)
    return replace(diagnosis, plain=replace(diagnosis.plain, base=base), extension=extension)


@pytest.mark.long(
    "takes two seconds",
    cases=(
        "1.2-good",
        "5.0-fair",
    ),
)
@pytest.mark.parametrize(("times_noise", "verdict"), [(1.2, "good"), (5.0, "fair")])
def test_one_loop_is_good_only_if_blocks_left_out_are_predicted(tmp_path, times_noise, verdict):
    u = temperatures(1, 120)
    noise = np.random.default_rng(4).normal(0.0, 0.02, u.size)
    path = tmp_path / "loop.csv"
    path.write_text(csv_text(np.arange(u.size) * 0.5, u, displacements(u) + noise), encoding="utf-8")
    studied = study([path], tmp_path / "out", StudyOptions())
    left_out = SimpleNamespace(rms=times_noise * studied.diagnosis.noise)
    result = replace(studied, diagnosis=with_fits(studied.diagnosis, left_out, None))
    assert (result.verdict, result.at_noise) == (verdict, verdict == "good")
    assert ("as blocks left out of the fit are predicted less well" in result._verdict_words()) == (
        verdict == "fair"
    )


@pytest.mark.long("takes two seconds")
def test_a_given_mapping_counts_without_a_question(files, tmp_path):
    study(files[:1], tmp_path / "draft", QUICK)
    mapping = tmp_path / "mine.toml"
    text = (tmp_path / "draft" / "mapping.toml").read_text(encoding="utf-8")
    mapping.write_text(text.replace('quantity = "displacement"', 'quantity = "stroke"'), encoding="utf-8")
    result = study(files, tmp_path / "out", StudyOptions(mapping=str(mapping), diagnose=False))
    assert [table.run.info.output.quantity for table in result.tables] == ["stroke"] * 3
    assert not (tmp_path / "out" / "mapping.toml").exists()
    assert str(mapping) in (tmp_path / "out" / "index.html").read_text(encoding="utf-8")


@pytest.mark.long("takes a second")
def test_a_later_part_is_held_out_and_keeps_the_memory(tmp_path):
    cycles = np.linspace(0, 5, 300)
    u = 70 - 45 * (1 - 0.15 * cycles) * np.cos(2 * np.pi * cycles)  # later cycles begin within the range
    path = tmp_path / "long.csv"
    path.write_text(csv_text(np.arange(u.size) * 0.5, u, displacements(u)), encoding="utf-8")
    result = study([path], tmp_path / "out", QUICK)
    assert result.split.kind == "time"
    (held_out,) = result.evaluation.best.held_out
    assert held_out.counted.all(), "the memory is carried over, so that every reading counts"
    assert not any("not recorded" in warning for warning in held_out.warnings)
    assert held_out.measured.size + len(result.split.train[0]) == u.size
    assert result.evaluation.best.rms < 0.2, "5 % of 4 mm, for loops inside those that were fitted"
    assert result.gain > 3


def test_an_output_without_hysteresis_earns_no_praise(tmp_path):
    u = temperatures(3, 60)
    x = 4 / (1 + np.exp(-(u - 70) / 8)) + np.random.default_rng(3).normal(0, 0.2, u.size)
    path = tmp_path / "plain.csv"
    path.write_text(csv_text(np.arange(u.size) * 0.5, u, x), encoding="utf-8")
    result = study([path], tmp_path / "out", QUICK)
    assert result.verdict != "good"
    assert "a function of the input" in result.sentences()[0]


def test_a_guess_that_is_not_sure_ends_with_what_to_say(tmp_path, capsys):
    rng = np.random.default_rng(0)
    path = tmp_path / "a.csv"
    path.write_text(
        "foo,bar\n" + "\n".join(f"{a},{b}" for a, b in rng.normal(1e5, 1e4, (40, 2))), encoding="utf-8"
    )
    assert cli(["study", str(path), "-o", str(tmp_path / "out")]) == 2
    said = capsys.readouterr().err
    assert "--input NAME" in said
    assert "--yes" in said
    assert (tmp_path / "out" / "mapping.toml").is_file()


UNITS = ["Unit of 'foo'", "Unit of 'bar'"]
ROLES = ["Which column is the input", "Which column is the output"]


@pytest.mark.parametrize(("loop", "asked"), [(True, UNITS), (False, [*ROLES, *UNITS])], ids=["loop", "line"])
def test_questions_are_asked_and_their_answers_count(tmp_path, loop, asked):
    """A loop says which column is its input; a line does not."""
    u = temperatures(2, 60) * 1e3
    x = (
        displacements(u / 1e3) * 1e4
        if loop
        else 0.3 * u + 1e3 + np.random.default_rng(0).normal(0, 50, u.size)
    )
    path = tmp_path / "a.csv"
    path.write_text("foo,bar\n" + "\n".join(f"{a},{b}" for a, b in zip(u, x)), encoding="utf-8")
    answers = {"Which column is the input": "foo", "Which column is the output": "bar"}
    count = []

    def ask(question, choices):
        count.append(question)
        return answers.get(question, "mK" if "foo" in question else "um")

    result = study([path], tmp_path / "out", QUICK, ask=ask)
    assert count == asked
    assert result.understood.questions == len(asked)
    assert result.tables[0].run.input_unit == "degC"


def test_names_and_units_from_the_command_line_count(files, tmp_path, capsys):
    arguments = [
        "--output",
        "Zeit",
        "--unit",
        "Zeit=mm",
        "--no-diagnosis",
        "--split",
        "none",
        "--yes",
        "--json",
    ]
    assert cli(["study", str(files[0]), *arguments, "-o", str(tmp_path / "out")]) in (0, 4)
    del capsys
    text = (tmp_path / "out" / "mapping.toml").read_text(encoding="utf-8")
    assert 'position = { column = "Zeit", unit = "mm" }' in text


@pytest.mark.long("takes a second")
def test_the_figures_of_a_study_are_saved_and_replaced(files, tmp_path, capsys):
    out, saved = tmp_path / "out", tmp_path / "figures"
    arguments = ["study", str(files[0]), "--no-diagnosis", "--yes", "-o", str(out), "--figures", str(saved)]
    for _ in range(2):
        assert cli(arguments) in (0, 4)
        assert {file.suffix for file in saved.iterdir()} == {".svg", ".pdf"}
    assert f"Figures: {saved}" in capsys.readouterr().err
    assert cli([*arguments, "--each"]) == 2
    assert "--figures saves those of one page" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("options", "said"),
    [
        (StudyOptions(split="load"), "three or more loads"),
        (StudyOptions(split="curve"), "reversal curves"),
        (StudyOptions(split="time"), "divides one run"),
        (StudyOptions(input="Wg"), "no column 'Wg'"),
    ],
)
def test_what_cannot_be_done_is_one_sentence(files, tmp_path, options, said):
    with pytest.raises(UsageError, match=said) as caught:
        study(files, tmp_path / "out", options)
    assert "\n" not in str(caught.value)


def test_files_without_a_table_are_refused(tmp_path):
    (tmp_path / "a.txt").write_text("nothing here\n")
    with pytest.raises(DataError, match="holds no table"):
        study([tmp_path / "a.txt"], tmp_path / "out")


@pytest.mark.long("takes three seconds")
def test_the_error_on_blocks_left_out_is_that_of_the_model_that_is_shown(tmp_path):
    """A learned term predicts better, but it is not the model of the first sentence."""
    u = temperatures(1, 120)
    path = tmp_path / "loop.csv"
    path.write_text(csv_text(np.arange(u.size) * 0.5, u, displacements(u)), encoding="utf-8")
    studied = study([path], tmp_path / "out", StudyOptions())
    shown, better = SimpleNamespace(rms=0.5), SimpleNamespace(rms=0.001, effects=())
    result = replace(studied, diagnosis=with_fits(studied.diagnosis, shown, better))
    assert result.evaluation.best.name == "positive measure"
    assert result._left_out == 0.5


@pytest.mark.parametrize(
    ("best", "told"),
    [
        (
            "one model of all loads",
            "The diagnosis is of a model that pools the loads (positive measure, 0.7 mm rms): ",
        ),
        ("positive measure", ""),
        ("extended model of the diagnosis", ""),
    ],
)
def test_it_is_told_which_model_was_diagnosed_where_another_is_judged(best, told, monkeypatch):
    candidates = tuple(
        CandidateModel(name, None, (), (), ()) for name in dict.fromkeys((best, "positive measure"))
    )
    monkeypatch.setattr(CandidateModel, "rms", 0.7)
    unknown = SimpleNamespace(verdict=SimpleNamespace(word="unknown"))
    of_loads: Any = SimpleNamespace(evaluation=Evaluation(candidates, {}, {}), unit="mm", diagnosis=unknown)
    assert StudyResult._diagnosed_model(of_loads) == told
    unknown.verdict.word = "named"
    assert StudyResult._diagnosed_model(of_loads) == ""


@pytest.mark.long("takes a second", cases=("50.0-none",))
@pytest.mark.parametrize(
    ("cold_K", "kind"),
    [(80.0, "time"), (50.0, "none")],  # later cycles transform; or stay below the transformation
)
def test_a_part_that_shows_no_transformation_is_not_held_out(tmp_path, cold_K, kind):
    ends = [25.0, 80.0, 25.0] + [cold_K, 25.0] * 3
    u = np.concatenate([np.linspace(a, b, 60) for a, b in zip(ends, ends[1:])])
    path = tmp_path / "one.csv"
    path.write_text(csv_text(np.arange(u.size) * 0.5, u, displacements(u)), encoding="utf-8")
    split = study([path], tmp_path / "out", QUICK).split
    assert split is not None
    assert split.kind == kind


def _measured_as(path, name):
    u = temperatures()
    rows = np.column_stack([0.5 * np.arange(u.size), u, displacements(u)])
    np.savetxt(path, rows, delimiter=",", header=f"time_s,T_degC,{name}", comments="", fmt="%.5f")
    return path


@pytest.mark.long("one of many cases", but_first=True)
@pytest.mark.parametrize("name", ["R_mFoo", "pos (smoots)"])
def test_the_terminal_says_how_to_state_a_unit(tmp_path, capsys, name):
    file = str(_measured_as(tmp_path / "data.csv", name))
    assert cli(["study", file, "-o", str(tmp_path / "out")]) == 2
    assert f"in which unit '{name}' is. Say --unit '{name}=UNIT'" in capsys.readouterr().err
    answer = ["study", file, "--unit", f"{name}=mohm", "--no-diagnosis", "-o", str(tmp_path / "out")]
    assert cli(answer) == 0
    assert f"{name}: output in mohm" in (shown := capsys.readouterr().err)
    assert "displacement" not in shown


def test_the_terminal_says_that_mm_are_assumed(tmp_path, capsys):
    file = str(_measured_as(tmp_path / "data.csv", "pos"))
    assert cli(["study", file, "--no-diagnosis", "-o", str(tmp_path / "out")]) == 0
    assert "pos: output, mm assumed" in capsys.readouterr().err
