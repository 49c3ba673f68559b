"""A register renamed in its TOML file: everything that depends on it fails and names it, and nothing else
does.

The test works in a copy of the project, as a person would: edit the file, build, start.
"""

import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[3]
FIRMWARE = "firmware_protocol/firmware"
SHORT = {"amplifier": "AMP", "encoder_daq": "DAQ"}
LONG = pytest.mark.long("takes up to ten seconds")
RENAMED = [
    pytest.param(("amplifier", "trip"), marks=LONG),
    pytest.param(("amplifier", "lease"), marks=LONG),
    ("encoder_daq", "ring_next"),
    pytest.param(("encoder_daq", "order"), marks=LONG),
]

DRIVE = {
    "amplifier": """
from smarig.device.drivers.smarig_amplifier import SmarigAmplifier, _settings
device = SmarigAmplifier(Scripted(load_register_map("amplifier")), _settings(load_rig("one_wire_serial")))
device.set(0.1), device.since(1, 4), device.off()
""",
    "encoder_daq": """
from smarig.device.drivers.smarig_encoder_daq import SmarigEncoderDaq
device = SmarigEncoderDaq(Scripted(load_register_map("encoder_daq")), 0.1)
device.since(1, 4), device.zero()
""",
}
BEFORE = """
import sys
sys.path.append(sys.argv[1])
from device.drivers.scripted import Scripted
from smarig.config import load_rig
from smarig.device.encoding.register import load_register_map
"""


@pytest.fixture
def renamed(tmp_path, request):
    """A copy of the project in which a device's register has another name."""
    device, name = request.param
    for folder in ("src", "simulators", "configs", "docs", "firmware_protocol"):
        shutil.copytree(
            ROOT / folder, tmp_path / folder, ignore=shutil.ignore_patterns("__pycache__", "*.svg")
        )
    path = tmp_path / f"firmware_protocol/{device}.toml"
    at = rf'(\[\[register\]\]\nname = |first = |last = )"{name}"'
    text, found = re.subn(at, r'\1"colour"', path.read_text("utf-8"))
    assert found
    path.write_text(text, "utf-8")
    return tmp_path, device, name


def python(folder, *arguments):
    """Python on the copy."""
    environment = os.environ | {
        "PYTHONPATH": f"{folder / 'src'}{os.pathsep}{folder}",
        "SMARIG_LOCK_DIR": str(folder),
    }
    command = [sys.executable, *arguments]
    return subprocess.run(
        command, cwd=folder, env=environment, capture_output=True, text=True, check=False, timeout=60
    )


@pytest.mark.long("takes three seconds", cases=("encoder_daq-ring_next",))
@pytest.mark.parametrize("renamed", RENAMED, indirect=True, ids=lambda r: "-".join(r))
def test_a_renamed_register_stops_what_is_generated_and_what_names_it(renamed):
    folder, device, name = renamed
    checked = python(folder, "-m", "smarig.device.encoding.generate", "--check")
    assert checked.returncode == 1
    assert "smarig_registers.h" in checked.stdout + checked.stderr
    assert "registers.md" in checked.stdout + checked.stderr
    simulated = python(folder, "-m", "smarig", "check", "one_wire_serial", "--yes")
    assert simulated.returncode != 0
    assert re.search(rf"register '({name}|colour)'", simulated.stderr)
    driven = python(folder, "-c", BEFORE + DRIVE[device], str(ROOT / "tests"))
    assert f"no register '{name}'" in driven.stderr, driven.stderr


@pytest.mark.parametrize("renamed", RENAMED, indirect=True, ids=lambda r: "-".join(r))
def test_the_firmware_does_not_compile_in_exactly_the_files_that_name_it(renamed):
    if not shutil.which("gcc"):
        pytest.skip("gcc is not installed")
    folder, device, name = renamed
    short = SHORT[device]
    assert python(folder, "-m", "smarig.device.encoding.generate").returncode == 0
    word = re.compile(rf"\b{short}_{name.upper()}(_\w+)?\b")
    others = set(re.findall(r"#define (\w+)", (folder / FIRMWARE / "smarig_registers.h").read_text("utf-8")))
    wrong, named = set(), set()
    for path in sorted((folder / FIRMWARE / "core").glob("*.c")):
        lines = path.read_text("utf-8").splitlines()
        named |= {
            (path.name, n)
            for n, line in enumerate(lines, 1)
            if any(m.group() not in others for m in word.finditer(line))
        }
        built = subprocess.run(
            ["gcc", "-std=c99", "-fsyntax-only", "-fmax-errors=0", str(path)],
            capture_output=True,
            text=True,
            check=False,
        )
        wrong |= {
            (Path(f).name, int(n)) for f, n in re.findall(r"^(\S+?):(\d+):\d+: error", built.stderr, re.M)
        }
    assert wrong <= named, "nothing else is wrong"
    assert {name for name, _ in wrong} == {name for name, _ in named} != set(), (
        "every file that names it is told"
    )
