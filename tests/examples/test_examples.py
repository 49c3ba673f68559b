"""The examples run as printed, each in its own folder, and print the documented results."""

import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

FOLDER = Path(__file__).resolve().parents[2] / "examples"
LONGEST = 60


def said_by(name, folder):
    """What an example prints; warnings are errors in it."""
    command = [sys.executable, "-W", "error", str(FOLDER / f"{name}.py")]
    done = subprocess.run(
        command, cwd=folder, env=dict(os.environ), capture_output=True, text=True, encoding="utf-8"
    )
    assert done.returncode == 0, f"{done.stdout}\n{done.stderr}"
    return done.stdout


def errors(said):
    """Label → rms error for each line with an error."""
    return {m[1]: float(m[2]) for m in re.finditer(r"^(\S+) .*?held-out run ([\d.]+) mm", said, re.M)}


def test_first_steps(tmp_path):
    said = said_by("first_steps", tmp_path)
    assert said.count("K above ambient →") == 14
    assert (tmp_path / "first_steps.html").stat().st_size > 50_000


@pytest.mark.long("takes five seconds")
def test_identify_your_wire(tmp_path):
    found = errors(said_by("identify_your_wire", tmp_path))
    assert set(found) == {"constant", "exponential", "positive"}
    assert found["exponential"] < 0.01 < found["positive"] < found["constant"]
    assert (tmp_path / "identified.model.json").is_file()


def test_read_someones_forc(tmp_path):
    said = said_by("read_someones_forc", tmp_path)
    loop = [float(m[1]) for m in re.finditer(r" T → (\S+) A m²", said)]
    assert len(loop) == 9
    assert loop[4] == pytest.approx(1e-6, rel=0.02)
    assert loop[6] > 5e-7 > -5e-7 > loop[2]  # at zero field: magnetised by what came before


@pytest.mark.long("takes ten seconds")
def test_find_the_hidden_effect(tmp_path):
    said = said_by("find_the_hidden_effect", tmp_path)
    assert "walking" in said.partition("Hidden in the twin")[0]
    assert (tmp_path / "diagnosed.model.json").is_file()


@pytest.mark.long("takes five seconds")
def test_close_the_loop(tmp_path):
    said = said_by("close_the_loop", tmp_path)
    off = {
        m[1]: float(m[2])
        for m in re.finditer(r"^(\w+) along multisine: error \S+ mm rms \((\S+) counts\)", said, re.M)
    }
    assert set(off) == {"inverse", "pi"}
    assert off["inverse"] < 0.8
    assert off["pi"] > 1.5 * off["inverse"]
    last = re.search(r"^Last \S+ s: mean error \S+ mm \((\S+) counts\)", said, re.M)
    assert last is not None
    assert abs(float(last[1].replace("\N{MINUS SIGN}", "-"))) < 2
    assert "at the end of the hold" not in said
    pushed = re.search(r"^Largest transient .*\((\S+) counts\)", said, re.M)
    assert pushed is not None
    assert 2 < float(pushed[1]) < 20


@pytest.mark.parametrize("path", sorted(FOLDER.glob("*.py")), ids=lambda path: path.stem)
def test_each_is_short_and_tested(path):
    assert len(path.read_text(encoding="utf-8").splitlines()) < LONGEST
    assert f"def test_{path.stem}(" in Path(__file__).read_text(encoding="utf-8")
