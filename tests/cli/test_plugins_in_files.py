"""A run or a model that names a plug-in imports nothing: whoever sends a file decides about no code."""

import json
import shutil
import sqlite3
import subprocess
import sys
from pathlib import Path

from cli.plugin_site import BENCH, RUN
from control.model_files import model_file
from runner.interrupted import cut
from smarig.cli import run as cli
from smarig.record import load_run

# Each of these opens the run or the model; none of them names a plug-in.
OPENING = """
list all
list plugins
check r.run.sqlite
check r.run.sqlite -o copy.run.sqlite
report r.run.sqlite
report --model effect.model.json r.run.sqlite -o models.html
report .
export r.run.sqlite --to csv -o r.csv
export form.model.json --to c -o form.c
resume killed.run.sqlite
resume changed.run.sqlite
resume benched.run.sqlite
verify effect.model.json r.run.sqlite
verify form.model.json r.run.sqlite
simulate effect.model.json --along r.run.sqlite -o s.run.sqlite
simulate rig.model.json --protocol validation --set points=2 -o s.run.sqlite
certify form.model.json
track form.model.json --reference ramps --set seconds=20 --rig one_wire_twin -o t.run.sqlite
regulate form.model.json --setpoint 6 --rig one_wire_twin -o t.run.sqlite
diagnose effect.model.json --train r.run.sqlite
transformation r.run.sqlite
calibrate r.run.sqlite --actuator gorbet_one_wire
identify r.run.sqlite --surface constant -o n.model.json
sense effect.model.json r.run.sqlite -o n.model.json
"""
PROGRAM = """
import contextlib, io, json, sys
import smarig
from smarig.cli import run
found = []
for line in json.loads(sys.argv[1]):
    with contextlib.redirect_stdout(io.StringIO()), contextlib.redirect_stderr(io.StringIO()) as said:
        status = run(line.split())
    found.append([line, status, said.getvalue(), "acme" in sys.modules])
smarig.load_run("r.run.sqlite")
for name in ("effect", "form", "rig"):
    with contextlib.suppress(Exception):
        smarig.load_model(name + ".model.json")
print(json.dumps([found, "acme" in sys.modules]))
"""


def test_opening_a_run_or_a_model_imports_no_plugin(acme):
    """Whoever sends a file cannot have a plug-in of ours imported, however the file names it."""
    assert cli([*RUN, "-o", "r.run.sqlite"]) == 0
    run = load_run("r.run.sqlite")
    cut(run.path, acme / "killed.run.sqlite", int(run["tick"][-1]) - 100)
    _hidden_names(acme)
    model = json.loads(model_file(acme, "one_e").read_text())
    effect = {"name": "acme_effect", "parameters": {"share_percent": 5.0, "time_constant_s": 60.0}}
    form = model["hysteresis"] | {"form": "acme_surface_form"}
    (acme / "bench.toml").write_text(BENCH)
    for name, change in (
        ("effect", {"effects": [effect]}),
        ("form", {"hysteresis": form}),
        ("rig", {"rig": "./bench.toml"}),
    ):
        (acme / f"{name}.model.json").write_text(json.dumps(model | change))
    lines = OPENING.strip().splitlines()
    done = subprocess.run(
        [sys.executable, "-c", PROGRAM, json.dumps(lines)],
        capture_output=True,
        text=True,
        check=True,
        timeout=300,
    )
    found, imported_at_the_end = json.loads(done.stdout)
    assert not imported_at_the_end
    assert [line for line, _, _, is_imported in found if is_imported] == []
    assert [line for line, status, _, _ in found if status == 1] == [], "no internal error"
    said = {line: text for line, _, text, _ in found}
    hint = "is a plug-in of acme 0.1.0, which is imported only if you name it: smarig --plugin"
    assert hint in said["verify effect.model.json r.run.sqlite"]
    assert hint in said["verify form.model.json r.run.sqlite"]
    assert hint in said["resume changed.run.sqlite"]
    assert "names the rig file './bench.toml', which is not read" in said["resume benched.run.sqlite"]
    assert "names the rig file './bench.toml', which is not read" in said[OPENING.strip().splitlines()[15]]


def _hidden_names(folder: Path) -> None:
    """Runs that name a plug-in as their protocol, or in the rig that they were made with, but hold no plug-in."""
    for name, rig in (("changed", "one_wire_twin"), ("benched", "./bench.toml")):
        changed = shutil.copy(folder / "killed.run.sqlite", folder / f"{name}.run.sqlite")
        with sqlite3.connect(changed) as db:
            launch = json.loads(db.execute("SELECT value FROM run WHERE key = 'begun_with'").fetchone()[0])
            launch |= {"rig": rig, "effects": []}
            db.execute("DELETE FROM run WHERE key = 'own_files'")
            db.execute("UPDATE run SET value = ? WHERE key = 'begun_with'", (json.dumps(launch),))
            if name == "benched":
                for key, value in (("rig", "one_wire_serial"), ("protocol", "validation")):
                    db.execute("UPDATE run SET value = ? WHERE key = ?", (json.dumps(value), key))
        db.close()
