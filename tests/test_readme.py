"""The commands and the code of the README run as printed."""

import os
import re
import shutil
import subprocess
import sys
import tomllib
from pathlib import Path

import pytest

import smarig
from docs.blocks import Command
from smarig.cli import run as cli
from smarig.plant import effects_from_arguments

pytestmark = pytest.mark.usefixtures("drawings")
ROOT = Path(__file__).resolve().parents[1]
BLOCKS = re.findall(r"```(\w+)\n(.*?)```", (ROOT / "README.md").read_text(encoding="utf-8"), flags=re.S)


def lines_of(language, contains):
    text = next(body for kind, body in BLOCKS if kind == language and contains in body)
    return [
        line.split("  #")[0].strip()
        for line in text.splitlines()
        if line.strip() and not line.startswith("#")
    ]


def environment():
    path = f"{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}"
    return {**os.environ, "PATH": path}


def in_shell(command, tmp_path):
    done = subprocess.run(
        command, shell=True, cwd=tmp_path, env=environment(), capture_output=True, text=True
    )
    assert done.returncode == 0, f"{command}\n{done.stdout}\n{done.stderr}"
    return done


@pytest.fixture
def run_line(tmp_path, monkeypatch):
    """Runs a line of the README in the test's folder."""
    monkeypatch.chdir(tmp_path)

    def do(line):
        words = Command(line, 0).words
        if words:
            assert cli(words) == 0, line
        else:
            in_shell(line, tmp_path)

    return do


def test_a_lab_day(tmp_path, run_line):
    for line in lines_of("sh", "smarig list "):
        run_line(line)
    made = {p.name for p in tmp_path.iterdir()}
    assert {"wire.model.json", "validation.html", "validation.csv"} <= made


def test_the_first_command_is_the_one_that_the_tutorial_makes():
    first = next(line for line in lines_of("sh", "venv") if "characterise" in line)
    command, _, out = first.rsplit("&& .venv/bin/", 1)[1].rpartition(" ")
    assert out == "out/one_wire"
    assert f"\n{command} first_wire\n" in (ROOT / "docs/tutorial/first_wire.md").read_text(encoding="utf-8")


@pytest.mark.skipif(sys.platform == "win32", reason="a script of bash")
def test_ci_reads_both_commands_out_of_this_page():
    """And runs what it read: no other line of the script creates the environment of a README command."""
    script = (ROOT / ".ci/run").read_text(encoding="utf-8")
    function = re.search(r"^readme\(\) \{.*?^\}", script, flags=re.S | re.M)
    assert function is not None
    for number, (name, command) in enumerate(
        zip(("first", "second"), lines_of("sh", "venv"), strict=True), 1
    ):
        read = subprocess.run(
            ["bash", "-c", f"{function[0]}\nreadme {number}"], cwd=ROOT, capture_output=True, text=True
        )
        assert read.stdout.strip() == command
        assert f"{name}=$(readme {number})" in script
        assert f'bash -c "${name}"' in script


@pytest.mark.skipif(sys.platform == "win32", reason="bash completion")
def test_shell_completion(tmp_path):
    done = in_shell("_SMARIG_COMPLETE=bash_source smarig", tmp_path)
    assert "_smarig_completion" in done.stdout
    typed = {"COMP_WORDS": "smarig run val", "COMP_CWORD": "2", "_SMARIG_COMPLETE": "bash_complete"}
    shipped_names = subprocess.run(["smarig"], env=environment() | typed, capture_output=True, text=True)
    assert "validation" in shipped_names.stdout


def test_seeing_it(tmp_path, run_line):
    """But for the two commands that open a viewer."""
    made = smarig.run(
        "validation", rig="one_wire_twin", out=tmp_path / "runs" / "v.run.sqlite", points=2
    ).path
    for name in ("fod", "validation", "seen"):
        shutil.copy(made, tmp_path / f"{name}.run.sqlite")
    commands = lines_of("sh", "--live")
    opening = [c for c in commands if " --live" in c or " view " in c]
    assert len(opening) == 2
    for command in commands:
        if command not in opening:
            run_line(command)
    assert {"comparison.html", "validation.nc"} <= {p.name for p in tmp_path.iterdir()}
    assert list((tmp_path / "runs").glob("index.html"))


def test_notebook_lines(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    code = next(body for kind, body in BLOCKS if kind == "python")
    names = {}
    exec(compile(code, "README.md", "exec"), names)
    assert names["result"].surface == "exponential"
    assert len(names["figure"].data) == 3  # path, settled points, model
    assert capsys.readouterr().out.strip()


def test_hysteresis_alone(monkeypatch, tmp_path, capsys):
    monkeypatch.chdir(tmp_path)
    code = next(body for kind, body in BLOCKS if kind == "python" and "certify" in body)
    names = {}
    exec(compile(code, "README.md", "exec"), names)
    assert names["wire"].peek(names["u"]) == pytest.approx(6.0, abs=1e-9)
    assert "Dissipative: no loop" in capsys.readouterr().out


@pytest.mark.long("takes twenty seconds; its commands are tried on the parser")
def test_a_measure_that_is_positive(tmp_path, run_line):
    run_line("smarig run validation --rig one_wire_twin -o validation.run.sqlite --seed 1")
    for command in lines_of("sh", "--surface positive"):
        run_line(command)
    assert (tmp_path / "positive.model.json").is_file()


@pytest.mark.long("takes twenty seconds; its commands are tried on the parser")
def test_closing_the_loop(tmp_path, run_line):
    made = smarig.run("first_order_descending", rig="one_wire_twin", out=tmp_path / "fod.run.sqlite", seed=1)
    smarig.identify(made, surface="exponential").model.save(tmp_path / "wire.model.json")
    for command in lines_of("sh", "smarig certify"):
        run_line(command)
    assert {"certificate.html", "held.html", "steps.run.sqlite"} <= {p.name for p in tmp_path.iterdir()}


def test_other_peoples_data(tmp_path, shared_data, run_line):
    (tmp_path / "forc.txt").write_bytes((shared_data / "forc_magnetic" / "MSM33-55-1_d330.forc").read_bytes())
    (tmp_path / "test.csv").write_bytes((shared_data / "sma_staircase" / "test.csv").read_bytes())
    for name in ("B_MnZn_HP_ferrite.mat", "H_MnZn_HP_ferrite.mat"):
        (tmp_path / name).write_bytes((shared_data / "ferrite_nested" / name).read_bytes())
    for command in lines_of("sh", "--format forc"):
        run_line(command)


@pytest.mark.long("takes twenty seconds; a walking wire is diagnosed in cli/test_diagnose.py")
def test_what_is_wrong_with_the_model(monkeypatch, tmp_path, capsys):
    monkeypatch.chdir(tmp_path)
    code = next(body for kind, body in BLOCKS if kind == "python" and "smarig.diagnose" in body)
    exec(compile(code, "README.md", "exec"), {})
    said = capsys.readouterr().out
    found = re.search(r"Found: walking \(rate (\S+) \[(\S+), (\S+)\]", said)
    assert found, "walking is found"
    assert "\nAgainst walking: lower the load" in said
    size, low, high = map(float, found.groups())
    assert low <= 0.4 <= high
    assert abs(size - 0.4) < 0.02
    assert (tmp_path / "walking.extended.model.json").is_file()


def test_effects_on_the_command_line(tmp_path, run_line):
    """But for the last command, which is that of the tutorial with an effect."""
    lines = lines_of("sh", "--effect walking=0.4")
    for line in lines[:-1]:
        run_line(line)
    runs = {path.name: smarig.load_run(path).info.effects for path in tmp_path.glob("*.sqlite")}
    assert len(runs) == 2
    assert [str(e).partition("(")[0] for e in runs["two_effects.run.sqlite"]] == ["ambient_drift", "creep"]
    assert lines[-1].startswith("smarig characterise ")
    assert effects_from_arguments((lines[-1].split("--effect ")[1].split()[0],))


def test_the_table_of_extras_is_that_of_the_package():
    extras = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))["project"]["optional-dependencies"]
    page = (ROOT / "README.md").read_text(encoding="utf-8").split("### Extras")[1].split("\n## ")[0]
    told = re.findall(r"^\| `(\w+)` \|", page, flags=re.M)
    assert sorted(told) == sorted(set(extras) - {"test", "docs", "dev"})
    every = re.fullmatch(r"smarig\[([\w,]+)\]", extras["all"][0])
    assert every is not None
    assert sorted(every[1].split(",")) == sorted(set(told) - {"all"})


def test_the_table_of_folders_names_each_package():
    """In the order of the layers, of which each stands in the table once."""
    table = (ROOT / "README.md").read_text(encoding="utf-8").partition("## Code structure")[2]
    named = re.findall(r"`(?:src/smarig/)?(\w+)/`", table.partition("| `benchmarks/`")[0])
    packages = {p.parent.name for p in (ROOT / "src" / "smarig").glob("*/__init__.py")}
    assert set(named) >= packages
    assert all(named.count(name) == 1 for name in packages)
