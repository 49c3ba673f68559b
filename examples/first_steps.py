"""First steps: run an experiment on the software twin, load the run, and inspect the data.

Writes first_steps.run.sqlite (all measured data) and first_steps.html (the report, one offline page).
"""

from pathlib import Path

import smarig
from smarig.report import run_page, write_page

FILE = Path("first_steps.run.sqlite")
FILE.unlink(missing_ok=True)

# The wire is heated to several temperatures and held at each until it has settled. The twin needs no hardware and
# simulates a quarter of an hour of rig time in a moment. To drive a bench, name another rig in the same call.
smarig.run("validation", rig="one_wire_twin", out=FILE, seed=1, points=12)

run = smarig.load_run(FILE)
print(run)
print(f"Columns have units: position in {run.unit}, hysteresis input in {run.input_unit}.")

# Settled points: one mean per hold. The output depends on past inputs, not only on the present one: hysteresis.
for temperature_K, position_mm in zip(*run.points()):
    print(f"  {temperature_K:6.1f} K above ambient → {position_mm:7.3f} mm")

page = write_page(run_page(run), "first_steps.html", force=True)
print(f"Report: {page}. In a notebook, run.plot() draws the run.")
