"""A wheel of a new package in a fresh environment: installed, listed, used in a run and in a diagnosis."""

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

from cli.plugin_site import KINDS, RIG, RUN
from smarig.cli.plugin_package import PLUGIN_KINDS


@pytest.mark.long("builds wheels and installs them")
def test_a_wheel_in_a_fresh_environment(tmp_path):
    """Built by pip, installed, listed, used in a run on the twin and in a diagnosis; it needs the network."""
    environment = {k: v for k, v in os.environ.items() if k != "PYTHONPATH"}

    def do(*words, status=0):
        done = subprocess.run(
            [str(w) for w in words],
            cwd=tmp_path,
            env=environment,
            capture_output=True,
            text=True,
            check=False,
        )
        assert done.returncode == status, f"{words}\n{done.stdout}\n{done.stderr}"
        return done

    root = Path(__file__).parents[2]
    do(sys.executable, "-m", "venv", "fresh")
    programs = tmp_path / "fresh" / ("Scripts" if os.name == "nt" else "bin")
    pip, smarig_ = (programs / "python", "-m", "pip", "-q"), programs / "smarig"
    do(*pip, "wheel", "--no-deps", "-w", "wheels", root)
    do(*pip, "install", *(tmp_path / "wheels").glob("smarig-*.whl"), "pytest")
    do(smarig_, "new", "plugin", "acme", *KINDS)
    do(*pip, "wheel", "--no-deps", "-w", "wheels", "./acme")
    do(*pip, "install", *(tmp_path / "wheels").glob("acme-*.whl"))
    assert len(json.loads(do(smarig_, "list", "plugins", "--json").stdout)["plugins"]) == len(PLUGIN_KINDS)
    do(programs / "python", "-m", "pytest", "-q", "acme/tests")
    do(smarig_, *RUN, "-o", "r.run.sqlite")
    runs = [f"{protocol}.run.sqlite" for protocol in ("wiping_out", "congruency", "first_order_descending")]
    for run in runs:
        words = ("run", run.partition(".")[0], *RIG, "--effect", "acme_effect=8", "--seed", 2, "-o", run)
        do(smarig_, *words, "--quiet")
    do(smarig_, "identify", *runs, "--surface", "positive", "-o", "w.model.json")
    trained = [word for run in runs for word in ("--train", run)]
    words = (
        "diagnose",
        "w.model.json",
        *trained,
        "--effect",
        "acme_effect",
        "--nulls",
        60,
        "-o",
        "diagnosis",
    )
    do(smarig_, *words)
    (effect,) = json.loads((tmp_path / "diagnosis" / "extended.model.json").read_text())["effects"]
    assert effect["name"] == "acme_effect"
    assert effect["parameters"]["share_percent"] == pytest.approx(8, abs=0.8)
    assert effect["parameters"]["time_constant_s"] == pytest.approx(60, abs=8)
    model = "diagnosis/extended.model.json"
    assert "smarig --plugin acme_effect" in do(smarig_, "verify", model, runs[0], status=4).stderr
    do(smarig_, "verify", model, runs[0], "--effect", "acme_effect")
    do(smarig_, "--plugin", "acme_effect", "verify", model, runs[0])
    opening = (
        "import contextlib, smarig, sys; smarig.load_run('r.run.sqlite')\n"
        f"with contextlib.suppress(Exception): smarig.load_model({model!r})\n"
    )
    do(programs / "python", "-c", f"{opening}sys.exit('acme' in sys.modules)")
