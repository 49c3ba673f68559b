"""The contract of every command: help with an example, one JSON object, exit status, one sentence per error."""

import contextlib
import json
import os
import subprocess
import sys

import pytest

from smarig.cli import run
from smarig.config import load_rig
from smarig.core.catalogue import catalogue_names
from smarig.record import load_run

COMMANDS = [n.rstrip("_") for n in catalogue_names("smarig.cli.commands")]


def call(capsys, *arguments):
    status = run([str(a) for a in arguments])
    out, err = capsys.readouterr()
    return status, out, err


@pytest.mark.parametrize("command", COMMANDS)
def test_help_has_an_example_and_json(capsys, command):
    status, out, _ = call(capsys, command, "--help")
    assert status == 0
    assert f"smarig {command}" in out
    assert "--json" in out
    assert "Example" in out
    assert "<=None" not in out, "a number without bounds has no range"


def test_the_root_lists_all_commands(capsys):
    status, out, _ = call(capsys, "--help")
    assert status == 0
    assert all(f"  {c}" in out for c in COMMANDS)


@pytest.mark.parametrize("kind", ["rigs", "actuators", "protocols", "campaigns"])
def test_list(capsys, kind):
    status, out, _ = call(capsys, "list", kind, "--json")
    assert status == 0
    assert all(json.loads(out)[kind].values())


def test_list_keys_has_every_key_of_a_rig_file(capsys):
    keys = json.loads(call(capsys, "list", "keys", "--json")[1])["keys"]
    rig = load_rig("one_wire_serial").model_dump(exclude_none=True)
    flat = {f"rig: {name}.{key}" for name, table in rig.items() if isinstance(table, dict) for key in table}
    assert flat | {f"rig: {name}" for name in rig} <= keys.keys()
    assert keys["rig: period_s"] == "number, ≥\u00a00.001, ≤\u00a060, s, needed: duration of a tick"
    assert keys["rig: hidden_effect"].startswith("true or false, default false: ")
    assert keys["rig: links.amplifier.line_end"].startswith(r'"\n", "\r\n", "\r", default "\n": ')
    assert {key.partition(": ")[0] for key in keys} == {"rig", "actuator", "campaign", "import"}
    assert "keys" not in json.loads(call(capsys, "list", "--json")[1])


def test_check_and_dry_run(capsys):
    status, out, _ = call(capsys, "check", "two_wire_twin", "--protocol", "initialise", "--json")
    found = json.loads(out)
    assert status == 0
    assert found["lease_trips"] is True
    assert found["preview"]["peak_current_A"] == pytest.approx(1.0, abs=0.01)
    status, out, _ = call(capsys, "run", "characterise", "--rig", "one_wire_twin", "--dry-run", "--json")
    assert len(json.loads(out)["preview"]) == 5


def test_run_json_is_one_object(capsys, tmp_path):
    out_file = tmp_path / "v.run.sqlite"
    status, out, _ = call(
        capsys, "run", "validation", "--rig", "one_wire_twin", "-o", out_file, "--set", "points=3", "--json"
    )
    assert status == 0
    assert json.loads(out)["runs"][0]["cause"] == "done"


SHORT = """
name = "short"
summary = "As quick_look, with fewer points."
[[step]]
protocol = "initialise"
purpose = "prepare"
[[step]]
protocol = "step_currents"
purpose = "test"
set = { currents_A = [0.3, 0.5] }
[[step]]
protocol = "validation"
purpose = "test"
set = { points = 2 }
"""


def test_a_campaign_makes_a_folder_of_runs_on_one_clock(capsys, tmp_path):
    import smarig

    short = tmp_path / "short.toml"
    short.write_text(SHORT)
    status, *_ = call(capsys, "run", short, "--rig", "one_wire_twin", "-o", tmp_path / "q", "--quiet")
    runs = [smarig.load_run(p) for p in sorted((tmp_path / "q").iterdir())]
    assert status == 0
    assert [run.meta["protocol"] for run in runs] == ["initialise", "step_currents", "validation"]
    assert all(a["tick"][-1] + 1 == b["tick"][0] for a, b in zip(runs, runs[1:], strict=False))


MISTAKES = [
    (2, ["run", "validaton", "--rig", "one_wire_twin", "-o", "x"], "did you mean validation"),
    (2, ["run", "validation", "--rig", "one_wire_twn", "-o", "x"], "did you mean one_wire_twin"),
    (2, ["run", "validation", "--rig", "one_wire_twin"], "-o"),
    (2, ["run", "validation", "--rig", "one_wire_twin", "-o", "x", "--set", "points"], "key=value"),
    (2, ["run", "validation", "--rig", "one_wire_twin", "-o", "x", "--seed", "-1"], "--seed"),
    (2, ["run", "characterise", "--rig", "one_wire_twin", "-o", "x", "--set", "a=1"], "campaign"),
    (2, ["nonsense"], "nonsense"),
    (2, ["identify", "nowhere.run.sqlite", "-o", "m.json"], "nowhere.run.sqlite"),
    (2, ["verify", "nowhere.json", "r.run.sqlite"], "nowhere.json"),
    (2, ["report", "nowhere.run.sqlite"], "nowhere.run.sqlite"),
    (2, ["import", "nowhere.csv", "--format", "csv", "-o", "r.run.sqlite"], "nowhere.csv"),
    (2, ["check", "nowhere.toml"], "nowhere.toml"),
]


@pytest.mark.parametrize(("status", "arguments", "says"), MISTAKES)
def test_a_mistake_gets_its_status_and_one_sentence(capsys, tmp_path, monkeypatch, status, arguments, says):
    monkeypatch.chdir(tmp_path)
    got, _, err = call(capsys, *arguments)
    assert got == status
    assert says in err
    assert "Traceback" not in err
    assert err.strip().count("\n") <= 1
    assert not [p for p in tmp_path.iterdir() if p.name != "locks"], "nothing half-written is left behind"


@pytest.mark.skipif(os.name == "nt", reason="pipes")
@pytest.mark.parametrize(("stream", "arguments"), [("stdout", ["list", "rigs"]), ("stderr", ["list", "rgs"])])
def test_a_closed_output_pipe_changes_no_status(capsys, monkeypatch, stream, arguments):
    """As with ``| head``; what is left for the interpreter to flush at its end goes nowhere."""
    status, *_ = call(capsys, *arguments)
    reader, writer = os.pipe()
    os.close(reader)
    with os.fdopen(writer, "w", encoding="utf-8") as unheard:
        monkeypatch.setattr(sys, stream, unheard)
        assert run(arguments) == status
        unheard.flush()


@pytest.mark.long("takes three seconds")
def test_a_run_whose_lines_nobody_reads_is_done(tmp_path):
    out = tmp_path / "unheard.run.sqlite"
    where = ["--rig", "one_wire_twin", "-o", str(out), "--wire", "unheard", "--set", "points=2"]
    reader, writer = os.pipe()
    os.close(reader)
    done = subprocess.run(
        [sys.executable, "-m", "smarig", "run", "validation", *where],
        stdout=writer,
        stderr=writer,
        check=False,
    )
    os.close(writer)
    assert done.returncode == 0
    assert load_run(out).cause == "done"


def test_errors_are_json_too(capsys):
    status, out, _ = call(capsys, "check", "nope", "--json")
    assert json.loads(out)["exit_status"] == status == 2


@contextlib.contextmanager
def recorded_by_another(path):
    """The process that holds the lock of a run file."""
    code = "import sys; from pathlib import Path; from smarig.record import recording\n"
    code += "with recording(Path(sys.argv[1])): print('held', flush=True); sys.stdin.read()"
    pipes = {"stdin": subprocess.PIPE, "stdout": subprocess.PIPE}
    with subprocess.Popen([sys.executable, "-c", code, str(path)], **pipes) as holder:
        holder.stdout.readline()
        yield holder
        holder.stdin.close()


def test_what_is_in_use_is_exit_status_5(capsys, tmp_path):
    """Whatever is asked of a run file that somebody records: one sentence, the same status, and nothing changed."""
    out = tmp_path / "v.run.sqlite"
    arguments = ["run", "validation", "--rig", "one_wire_twin", "-o", out, "--set", "points=2"]
    assert call(capsys, *arguments)[0] == 0
    before = out.read_bytes()
    with recorded_by_another(out) as holder:
        table = tmp_path / "t.csv"
        table.write_text("time_s,current_A,position_mm\n" + "".join(f"{k},0.1,{k / 10}\n" for k in range(20)))
        for command in (
            arguments,
            [*arguments, "--force"],
            ["resume", out],
            ["import", table, "--format", "csv", "-o", out, "--force"],
        ):
            status, _, err = call(capsys, *command)
            assert status == 5, err
            assert f"v.run.sqlite is being recorded by process {holder.pid} since " in err
            assert err.strip().count("\n") == 0
        status, text, _ = call(capsys, "resume", out, "--json")
        assert json.loads(text)["exit_status"] == status == 5
    assert out.read_bytes() == before


def test_existing_runs_are_not_overwritten(capsys, tmp_path):
    out = tmp_path / "v.run.sqlite"
    arguments = ["run", "validation", "--rig", "one_wire_twin", "-o", out, "--set", "points=2"]
    assert call(capsys, *arguments)[0] == 0
    before = out.read_bytes()
    status, _, err = call(capsys, *arguments)
    assert status == 2
    assert "--force" in err
    assert out.read_bytes() == before
    assert call(capsys, *arguments, "--force")[0] == 0


def test_a_damaged_run_is_a_data_error(capsys, tmp_path):
    broken = tmp_path / "b.run.sqlite"
    broken.write_bytes(b"SQLite format 3\0" + b"\1" * 5000)
    status, _, err = call(capsys, "report", broken)
    assert status == 4
    assert "b.run.sqlite" in err


def cooled(tmp_path, kelvin):
    from smarig.config import locate

    cool = tmp_path / "cool.toml"
    text = locate("rigs", "one_wire_twin").read_text(encoding="utf-8")
    cool.write_text(
        text.replace("temperature_max_K = 185.0", f"temperature_max_K = {kelvin}"), encoding="utf-8"
    )
    return cool


def test_what_would_trip_is_not_started(capsys, tmp_path):
    arguments = [
        "run",
        "minor_loops",
        "--rig",
        cooled(tmp_path, 90.0),
        "--set",
        "high_A=1",
        "--set",
        "loop_s=60",
    ]
    status, _, err = call(capsys, *arguments, "-o", tmp_path / "r.run.sqlite")
    assert status == 2
    assert "not started" in err
    assert "temperature_max_K = 90" in err
    assert not (tmp_path / "r.run.sqlite").exists()


def test_partitions_follow_the_limits(capsys, tmp_path):
    cool = cooled(tmp_path, 90.0)
    status, out, _ = call(capsys, "check", cool, "--protocol", "first_order_descending", "--json")
    found = json.loads(out)
    assert status == 0
    assert found["input_range_K"] == [0.0, 89.5]
    assert 89 < found["preview"]["peak_temperature_K"] < 90


def test_an_unwritable_folder_is_reported(capsys, tmp_path):
    (tmp_path / "file").write_text("not a folder")
    status, _, err = call(
        capsys, "characterise", "--rig", "one_wire_twin", "--out", tmp_path / "file" / "out"
    )
    assert status == 4
    assert "cannot be written" in err


@pytest.mark.long("takes three seconds")
def test_a_folder_of_runs_gets_a_page_each(capsys, tmp_path):
    call(capsys, "run", "quick_look", "--rig", "one_wire_twin", "-o", tmp_path / "q", "--quiet")
    status, out, _ = call(capsys, "report", tmp_path / "q", "--json")
    assert status == 0
    assert len(json.loads(out)["reports"]) == 3
    assert len(list((tmp_path / "q").glob("*.html"))) == 4  # and the index
    assert call(capsys, "report", tmp_path / "q", "-o", tmp_path / "one.html")[0] == 2


@pytest.mark.long("takes three seconds")
def test_any_run_gives_a_positive_model(capsys, tmp_path):
    recorded, model = tmp_path / "v.run.sqlite", tmp_path / "v.model.json"
    call(capsys, "run", "validation", "--rig", "one_wire_twin", "-o", recorded, "--set", "points=12")
    status, out, _ = call(capsys, "identify", recorded, "--surface", "positive", "-o", model, "--json")
    found = json.loads(out)
    assert status == 0
    assert found["surface"] == "positive"
    assert found["classes"] == {"M_PC": True, "M_P": True}
    assert found["mu_min"] >= 0
    assert found["fit"]["symmetric"] is False
    status, out, _ = call(capsys, "verify", model, recorded, "--json")
    assert status == 0
    assert json.loads(out)["runs"][0]["nrmse"] < 0.02


def test_a_model_of_a_run_that_is_being_recorded_says_so(capsys, tmp_path):
    fod, words = tmp_path / "f.run.sqlite", ["identify", tmp_path / "f.run.sqlite", "--surface", "constant"]
    levels = ["--set", "partition_K=0,40,90,170"]
    call(capsys, "run", "first_order_descending", "--rig", "one_wire_twin", "-o", fod, *levels)
    warning = f"Warning: {fod} is being recorded. The model describes only the rows so far."
    with recorded_by_another(fod):
        assert warning in call(capsys, *words, "-o", tmp_path / "now.model.json")[2]
    assert warning not in call(capsys, *words, "-o", tmp_path / "f.model.json")[2]


def test_symmetry_is_for_the_positive_surface_and_a_range_around_zero(capsys, tmp_path):
    fod, model = tmp_path / "f.run.sqlite", tmp_path / "f.model.json"
    levels = ["--set", "partition_K=0,40,90,130,170"]
    call(capsys, "run", "first_order_descending", "--rig", "one_wire_twin", "-o", fod, *levels)
    for surface, expected, says in (
        ("table", 2, "positive surface only"),
        ("positive", 4, "range around zero"),
    ):
        status, _, err = call(capsys, "identify", fod, "--surface", surface, "--symmetric", "-o", model)
        assert status == expected
        assert says in err
        assert err.strip().count("\n") == 0
    assert not model.exists()


@pytest.mark.long("takes three seconds")
def test_controllers_are_listed_without_docstrings():
    """``python -OO`` removes them."""
    words = [sys.executable, "-OO", "-m", "smarig", "list", "controllers", "--settings"]
    found = subprocess.run(words, capture_output=True, text=True, check=True)
    assert "pi (regulate)" in found.stdout


@pytest.mark.parametrize("given", ["abc", "", "-5", "1.5", "²", "99999999999999999", "9" * 5000])
def test_a_source_date_that_is_no_time_is_one_sentence(capsys, monkeypatch, given):
    monkeypatch.setenv("SOURCE_DATE_EPOCH", given)
    status, out, err = call(capsys, "list", "rigs")
    assert (status, out) == (2, "")
    assert err.startswith("smarig: The environment variable SOURCE_DATE_EPOCH is '")
    assert "Traceback" not in err
    assert len(err.splitlines()) == 1


@pytest.mark.parametrize("given", ["0", "1700000000", "253402300799"])
def test_a_source_date_is_accepted(capsys, monkeypatch, given):
    monkeypatch.setenv("SOURCE_DATE_EPOCH", given)
    assert call(capsys, "list", "rigs")[0] == 0
