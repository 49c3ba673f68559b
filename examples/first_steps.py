"""First steps: run an experiment on the software twin, read it back, and look at what it measured.

Writes first_steps.run.sqlite (everything measured) and first_steps.html (open it: one offline page).
"""

from pathlib import Path

import smarig
from smarig.report import run_page, write_page

FILE = Path("first_steps.run.sqlite")
FILE.unlink(missing_ok=True)

# The wire is heated to a few temperatures; at each it is held until it stands still. The twin needs no hardware and
# takes its quarter of an hour of rig time in a moment. The same call drives a bench: name another rig.
smarig.run("validation", rig="one_wire_twin", out=FILE, seed=1, points=12)

run = smarig.load_run(FILE)
print(run)
print(f"Columns have units: position in {run.unit}, hysteresis input in {run.input_unit}.")

# Settled points: one mean for each hold. The output depends on how an input was approached: that is hysteresis.
for temperature_K, position_mm in zip(*run.points()):
    print(f"  {temperature_K:6.1f} K above ambient → {position_mm:7.3f} mm")

page = write_page(run_page(run), "first_steps.html", force=True)
print(f"In a notebook, run.plot() draws it; here is a page: {page}")
