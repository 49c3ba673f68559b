"""smarig finds the plug-ins of this package without importing them."""

import json
import subprocess
import sys
import tomllib
from pathlib import Path

PROJECT = tomllib.loads((Path(__file__).parents[1] / "pyproject.toml").read_text(encoding="utf-8"))["project"]
NAMES = {name for group in PROJECT["entry-points"].values() for name in group}
PROGRAM = """
import sys
from smarig.cli import run
status = run(["list", "plugins", "--json"])
sys.exit(status or (3 if "my_plugin" in sys.modules else 0))
"""


def test_smarig_lists_the_plugins_and_imports_none():
    listed = subprocess.run([sys.executable, "-c", PROGRAM], capture_output=True, text=True, check=True)
    found = json.loads(listed.stdout)["plugins"]
    assert found.keys() >= NAMES, "install this package again: its entry points have changed"
    assert {name: found[name] for name in NAMES if "cannot be used" in found[name]} == {}
