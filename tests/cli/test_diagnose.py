"""``smarig diagnose``: its JSON object, its files and its errors."""

import json
from dataclasses import replace

import pytest

import smarig
from diagnosed_twin import TRAIN, WALKING, command, diagnosed_twin
from smarig.cli import run as cli
from smarig.plant.effect_catalogue import effect_types


@pytest.fixture(scope="module")
def session_folder():
    """Runs of one twin that walks, and the model identified from them."""
    return diagnosed_twin().folder


@pytest.fixture(scope="module")
def diagnosed():
    """What the command printed, and what it had found."""
    twin = diagnosed_twin()
    return twin.printed, twin.diagnosis


@pytest.fixture(scope="module")
def found(diagnosed):
    return diagnosed[0]


def test_its_object_has_the_keys_others_rely_on(found):
    keys = {
        "verdict",
        "effects",
        "set",
        "depends_on",
        "not_identifiable",
        "error",
        "held_out",
        "separating_run",
    }
    more = {
        "causes",
        "hypotheses",
        "missing_knowledge",
        "reason",
        "adequacy",
        "learned",
        "numerics",
        "stands_out",
    }
    assert keys | more | {"alpha", "nulls", "model", "seconds"} <= set(found)
    assert "p_value" not in found
    assert {"unit", "noise_floor", "base", "extended"} <= set(found["error"])
    assert {"base", "extended", "removable_share", "ci95", "blocks"} <= set(found["held_out"])


def test_it_names_the_injected_effect(found):
    """A twin's readings are so precise that a small second effect may be reported as well."""
    assert found["verdict"] in ("named", "ambiguous")
    walking = next(e for e in found["effects"] if e["name"] == "walking")
    assert walking["probability"] > 0.9
    value = walking["parameters"]["percent_per_cycle"]
    assert value["unit"] == "%/cycle"
    assert value["value"] == pytest.approx(WALKING, rel=0.05)
    assert found["held_out"]["removable_share"] > 0.9


def test_unrecorded_time_between_runs_is_reported(diagnosed):
    found = diagnosed[1]
    assert "not recorded" not in found.text()
    first, *rest = found.timeline.runs
    late = [replace(run, columns=run.columns | {"t_s": run["t_s"] + 1500.0}) for run in rest]
    timeline = replace(found.timeline, runs=(first, *late))
    apart = replace(found, subject=replace(found.subject, timeline=timeline))
    assert "25 min between these runs are not recorded" in apart.text()


@pytest.mark.long("takes a second")
def test_verify_evaluates_the_extended_model(found, session_folder, capsys):
    def rms(model):
        capsys.readouterr()
        assert cli(["verify", str(model), str(session_folder / "validation.run.sqlite"), "--json"]) == 0
        return json.loads(capsys.readouterr().out)["runs"][0]["rms"]

    extended = smarig.load_model(found["model"])
    assert "walking" in [e["name"] for e in extended.effects]
    assert rms(found["model"]) < 0.7 * rms(session_folder / "wire.model.json")


def test_the_diagnosis_and_verify_count_one_error_of_the_extended_model(diagnosed, session_folder):
    """Its file has the zero of the training runs, so verify finds what the diagnosis prints."""
    gain = diagnosed[1].gain
    runs = [smarig.load_run(session_folder / f"{name}.run.sqlite") for name in (*TRAIN, "validation")]
    model = smarig.load_model(session_folder / "out" / "extended.model.json")
    verified = smarig.verify(model, runs).runs[-1]
    assert verified.offset_kind == "known"
    assert gain.settled_rms(gain.extended_error) == pytest.approx(verified.settled.rms, rel=0.1)
    assert f"{gain.settled_rms(gain.extended_error):.4g} mm. The figures before" in diagnosed[1].text()


@pytest.mark.long("takes a second")
def test_the_extended_model_simulates(found, session_folder, tmp_path):
    along = session_folder / "validation.run.sqlite"
    out = tmp_path / "simulated.run.sqlite"
    assert cli(["simulate", found["model"], "--along", str(along), "-o", str(out)]) == 0
    assert smarig.load_run(out).has("position")
    again = tmp_path / "protocol.run.sqlite"
    model = found["model"]
    assert cli(["simulate", model, "--protocol", "validation", "--set", "points=3", "-o", str(again)]) == 0


def test_a_page_and_the_object_are_written(found, session_folder):
    page = (session_folder / "out" / "report.html").read_text(encoding="utf-8")
    assert "walking" in page
    assert "TWIN" in page
    assert json.loads((session_folder / "out" / "diagnosis.json").read_text())["verdict"] == found["verdict"]


@pytest.mark.parametrize(
    ("more", "status", "sentence"),
    [
        (["--alpha", "0.7"], 2, "between 0.005 and 0.5"),
        (["--alpha", "0.001"], 2, "between 0.005 and 0.5"),
        (["--nulls", "3"], 2, "at least"),
        (["--nulls", "99999999999"], 2, "at most"),
        (["--without", "wobble"], 2, "wobble"),
    ],
)
def test_senseless_settings_are_refused_in_a_sentence(session_folder, capsys, more, status, sentence):
    assert cli(command(session_folder, *more)) == status
    assert sentence in capsys.readouterr().err


def test_existing_results_are_not_replaced(found, session_folder, capsys):
    assert cli(command(session_folder, "-o", str(session_folder / "out"))) == 2
    assert "--force" in capsys.readouterr().err


def test_a_run_cannot_be_training_and_held_out(session_folder, capsys):
    run = str(session_folder / "validation.run.sqlite")
    model = str(session_folder / "wire.model.json")
    assert cli(["diagnose", model, "--train", run, "--held-out", run]) == 2
    assert "is given to both --train and --held-out" in capsys.readouterr().err


@pytest.mark.long
def test_runs_of_two_sessions_are_one_timeline_with_two_zeros(session_folder, tmp_path, capsys):
    other = tmp_path / "other.run.sqlite"
    assert cli(["run", "validation", "--rig", "one_wire_twin", "--set", "points=3", "-o", str(other)]) == 0
    train = str(session_folder / "congruency.run.sqlite")
    model = str(session_folder / "wire.model.json")
    without = [
        part for k in effect_types() if k.name not in ("walking", "slip") for part in ("--without", k.name)
    ]
    capsys.readouterr()
    line = ["diagnose", model, "--train", train, "--train", str(other), "--nulls", "40", "--json"]
    assert cli([*line, *without]) == 0
    found = json.loads(capsys.readouterr().out)
    assert found["error"]["base"] < 0.1


def test_a_training_run_given_twice_is_refused(session_folder, capsys):
    train = str(session_folder / "congruency.run.sqlite")
    twice = ["diagnose", str(session_folder / "wire.model.json"), "--train", train, "--train", train]
    assert cli(twice) == 2
    assert "hold the same readings, which would count twice" in capsys.readouterr().err


@pytest.mark.parametrize("name", ["wire.model.json", "congruency.run.sqlite", "validation.run.sqlite"])
def test_a_proposal_is_never_written_over_an_input(session_folder, name, capsys):
    before = (session_folder / name).read_bytes()
    assert cli(command(session_folder, "--propose", str(session_folder / name), "--force")) == 2
    assert "both input and output" in capsys.readouterr().err
    assert (session_folder / name).read_bytes() == before


def test_nor_is_a_diagnosis(session_folder, tmp_path, capsys):
    model = tmp_path / "extended.model.json"
    model.write_bytes((session_folder / "wire.model.json").read_bytes())
    words = command(session_folder, "-o", str(tmp_path), "--force")
    words[1] = str(model)
    assert cli(words) == 2
    assert "both input and output" in capsys.readouterr().err


def test_a_campaign_that_could_not_be_written_is_refused_before_anything_is_computed(
    session_folder, tmp_path, capsys
):
    (tmp_path / "none").write_text("no folder")
    assert cli(command(session_folder, "--propose", str(tmp_path / "none" / "next.toml"))) == 2
    out, err = capsys.readouterr()
    assert out == ""
    assert "none is not a folder" in err
    assert "settled points" not in err


def test_an_option_is_no_file(session_folder, capsys):
    assert cli(["diagnose", str(session_folder / "wire.model.json"), "--train", "--json"]) == 2
    assert "A file is missing before --json." in capsys.readouterr().err


def test_a_diagnosis_is_on_disk_before_a_proposal_is_sought(session_folder, diagnosed, tmp_path, monkeypatch):
    def fails(found, progress):
        raise KeyboardInterrupt

    monkeypatch.setattr("smarig.app.propose_run", fails)
    monkeypatch.setattr("smarig.diagnosis.diagnose", lambda *_, **__: diagnosed[1])
    out = tmp_path / "out"
    words = ["-o", str(out), "--propose", str(tmp_path / "next.toml"), "--nulls", "40"]
    assert cli(command(session_folder, *words)) == 130
    assert {"diagnosis.json", "extended.model.json", "report.html"} <= {p.name for p in out.iterdir()}


def test_a_copy_of_a_training_run_cannot_be_held_out(session_folder, tmp_path, capsys):
    copy = tmp_path / "copy.run.sqlite"
    copy.write_bytes((session_folder / "congruency.run.sqlite").read_bytes())
    words = command(session_folder)
    words[-1] = str(copy)
    assert cli(words) == 2
    assert "copy of a training run" in capsys.readouterr().err


def verified(capsys, model, run):
    capsys.readouterr()
    assert cli(["verify", str(model), str(run), "--json"]) == 0
    (result,) = json.loads(capsys.readouterr().out)["runs"]
    return result["rms"], " ".join(result["warnings"])


@pytest.mark.long("takes a second")
def test_an_extended_model_is_verified_along_the_whole_session_or_reports_missing_runs(
    found, session_folder, tmp_path, capsys
):
    """They are looked for beside the given run, whatever their recorded folder."""
    run = session_folder / "validation.run.sqlite"
    rms, warnings = verified(capsys, found["model"], run)
    assert "earlier in the session" not in warnings
    moved = tmp_path / "moved.model.json"
    moved.write_text(
        (session_folder / "out/extended.model.json").read_text().replace(str(session_folder), "/nowhere")
    )
    assert verified(capsys, moved, run) == (rms, warnings)
    alone = tmp_path / "alone" / run.name
    alone.parent.mkdir()
    alone.write_bytes(run.read_bytes())
    astray, warnings = verified(capsys, moved, alone)
    assert "depend on earlier runs of the session, but" in warnings
    assert astray > 2 * rms
