"""Read someone's FORC file: import first-order reversal curves of a magnet, identify a model, and predict a loop.

The data are synthetic (a magnet whose grains switch around 0.05 T) and written in the text format of a common
magnetometer. What it shows: the same model describes magnets and wires, and you need not edit other people's files.
"""

from pathlib import Path

import numpy as np

import smarig
from smarig.cli import run as smarig_command

FIELD_T = np.linspace(-0.2, 0.2, 33)
COERCIVITY_T, WIDTH_T, MOMENT_Am2 = 0.05, 0.02, 1e-6
NOISE_Am2 = 2e-10


def moment(field_T: np.ndarray, reversal_T: float) -> np.ndarray:
    """Moments on the reversal curve from ``reversal_T``: grains that had switched down switch up again."""
    down = 1 / (1 + np.exp((reversal_T + COERCIVITY_T) / WIDTH_T))
    up = 1 / (1 + np.exp(-(field_T - COERCIVITY_T) / WIDTH_T))
    first = 1 / (1 + np.exp(-(reversal_T - COERCIVITY_T) / WIDTH_T))
    back = np.clip((up - first) / (1 - first), 0, 1)
    return MOMENT_Am2 * (1 - 2 * down * (1 - back))


noise = np.random.default_rng(5)
lines = ["MicroMag 2900/3900 Data File (Series 0016)", "First-order reversal curves", ""]
lines += ["INSTRUMENT", "Units of measure       Hybrid SI", f"NForc   {FIELD_T.size - 2}", ""]
for reversal_T in FIELD_T[-2:0:-1]:
    field_T = FIELD_T[reversal_T <= FIELD_T]
    values = moment(field_T, reversal_T) + NOISE_Am2 * noise.standard_normal(field_T.size)
    lines += [f"{h:+.6E},{m:+.6E}" for h, m in zip(field_T, values)] + [""]
Path("magnet.txt").write_text("\n".join([*lines, "MicroMag 2900/3900 Data File ends", ""]), encoding="utf-8")

status = smarig_command(["import", "magnet.txt", "--format", "forc", "-o", "magnet.run.sqlite", "--force"])
if status:
    raise SystemExit(status)

run = smarig.load_run("magnet.run.sqlite")
print(run)
model = smarig.identify(run, surface="table").model
print(model)
loop_T = np.concatenate([np.linspace(-0.2, 0.2, 5), np.linspace(0.2, -0.2, 5)[1:]])
for field_T, moment_Am2 in zip(loop_T, model.predict(loop_T)):
    print(f"  {field_T:+.2f} T → {moment_Am2:+.2e} A m²")
