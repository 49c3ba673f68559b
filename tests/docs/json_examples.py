"""Runs every command with --json on the twin and stores the output: ``PYTHONPATH=tests python
tests/docs/json_examples.py``.

It writes docs/generate/json_examples.json, which the reference shows.
"""

import contextlib
import io
import json
import os
import re
import shlex
import sys
import tempfile
from pathlib import Path

from runner.interrupted import cut
from smarig.cli import run as cli

KEPT = Path(__file__).resolve().parents[2] / "docs" / "generate" / "json_examples.json"
RIG = "--rig one_wire_twin"
LEVELS = "--set partition_K=0,40,90,130,170"
QUICK = f"""
new protocol two_loops
new plugin acme --kind effect --kind protocol
check one_wire_twin --protocol first_order_descending
run validation {RIG} --dry-run
run validation {RIG} -o validation.run.sqlite --seed 1 --set points=4
report validation.run.sqlite
report .
run first_order_descending {RIG} -o fod.run.sqlite --seed 1 {LEVELS}
resume stopped.run.sqlite
identify fod.run.sqlite --surface exponential -o wire.model.json
identify fod.run.sqlite --surface positive -o positive.model.json
identify fod.run.sqlite -o best.model.json
identify fod.run.sqlite validation.run.sqlite --surface exponential --extension best -o extended.model.json
verify wire.model.json validation.run.sqlite
simulate wire.model.json --along validation.run.sqlite -o simulated.run.sqlite
calibrate validation.run.sqlite --actuator gorbet_one_wire
certify wire.model.json
certify wire.model.json --run validation.run.sqlite --position-controller 10,20/1,0.5
track wire.model.json --reference ramps --set seconds=10 {RIG} -o tracked.run.sqlite
track wire.model.json --reference ramps --set seconds=10 --controller leaky_pi --offset-K 30 {RIG} -o velocity.run.sqlite
regulate wire.model.json --setpoint 6 --hold-s 60 {RIG} -o held.run.sqlite
list
list protocols --settings
export validation.run.sqlite --to csv -o mine.csv
import mine.csv --format csv {RIG} -o mine.run.sqlite
report --model wire.model.json --model positive.model.json validation.run.sqlite -o models.html
check validation.run.sqlite -o copy.run.sqlite
run constant_force_cycles {RIG} -o cycles.run.sqlite --seed 1 --set cycles=1 --set points=16
transformation cycles.run.sqlite
report cycles.run.sqlite
sense wire.model.json fod.run.sqlite validation.run.sqlite -o sensing.model.json
sense sensing.model.json validation.run.sqlite
regulate sensing.model.json --setpoint 6 --hold-s 60 --feedback resistance {RIG} -o observed.run.sqlite
"""
TRAIN = ("wiping_out", "congruency", "first_order_descending")
WALKING = " ".join(f"--train {name}.run.sqlite" for name in TRAIN)
LONG = f"""
check one_wire_serial --yes
{"".join(f"run {name} {RIG} -o {name}.run.sqlite --seed 2 --effect walking=0.4{chr(10)}" for name in TRAIN)}
run validation {RIG} -o held_out.run.sqlite --seed 2 --effect walking=0.4 --set points=15
identify {" ".join(f"{name}.run.sqlite" for name in TRAIN)} --surface positive -o walking.model.json
diagnose walking.model.json {WALKING} --held-out held_out.run.sqlite -o diagnosis --propose next.toml
characterise {RIG} --out out/one_wire
benchmark inverse --quick
view validation.run.sqlite --save validation.rrd
"""


def printed_objects(commands: str) -> list[tuple[str, dict]]:
    """(command, its object) of each line, run in the present folder."""
    found = []
    for line in filter(str.strip, commands.splitlines()):
        words = shlex.split(line)
        if words[0] == "resume":
            cut(Path("fod.run.sqlite"), Path(words[1]), tick=3000)
        heard = io.StringIO()
        with contextlib.redirect_stdout(heard), contextlib.redirect_stderr(io.StringIO()):
            status = cli([*words, "--json"])
        assert status == 0, f"{line}: {heard.getvalue()}"
        found.append((f"smarig {line}", json.loads(heard.getvalue())))
    return found


def main() -> None:
    """Generate all examples again."""
    with tempfile.TemporaryDirectory() as folder:
        os.environ |= {"SMARIG_LOCK_DIR": f"{folder}/.locks", "SMARIG_HISTORY_DIR": f"{folder}/.wires"}
        os.chdir(folder)
        kept = [{"command": command, "output": output} for command, output in printed_objects(QUICK + LONG)]
    text = json.dumps(kept, indent=1, ensure_ascii=False)
    text = re.sub(rf"{re.escape(tempfile.gettempdir())}/[\w-]+/", "", text)  # where simulated devices listen
    assert tempfile.gettempdir() not in text, "no path of this machine"
    KEPT.write_text(text + "\n", encoding="utf-8")
    sys.stderr.write(f"{KEPT.name}: {len(kept)} examples, {len(text)} bytes\n")


if __name__ == "__main__":
    main()
