"""Close the loop, as far as a model alone goes: the inverse of the hysteresis as feed-forward on the twin.

A path of positions is asked for; the model says which temperatures reach them, the rig makes those, and what the wire
did is compared. What it shows: inverting the memory brings a wire where a plain calibration curve does not.
"""

from pathlib import Path

import numpy as np

import smarig
from smarig.rig.twin import TwinSettings
from smarig.runner.session import Session

WANTED_mm = np.array([3.0, 9.0, 5.0, 11.0, 7.0, 10.0, 4.0, 8.0])


def profile(name: str, temperature_K: np.ndarray) -> str:
    """A CSV that the protocol ``step_currents`` holds, one temperature above ambient after the other."""
    Path(name).write_text("temperature_K\n" + "".join(f"{t:.3f}\n" for t in temperature_K), encoding="utf-8")
    return name


names = ("loop_curves", "loop_inverse", "loop_calibrated")
files = {name: Path(f"{name}.run.sqlite") for name in names}
for file in files.values():
    file.unlink(missing_ok=True)

with Session("one_wire_twin", twin=TwinSettings(seed=4)) as session:
    session.run("first_order_descending", {}, files["loop_curves"])
    model = smarig.identify(files["loop_curves"], surface="exponential").model

    # The model's memory moves along with the commands; nothing is measured in between.
    commands = {"loop_inverse": model.preisach().inverse_trajectory(WANTED_mm)}
    rising_K = np.linspace(model.hysteresis.lower, model.hysteresis.upper, 400)
    commands["loop_calibrated"] = np.interp(WANTED_mm, model.predict(rising_K), rising_K)
    for name, temperature_K in commands.items():
        session.run("step_currents", {"file": profile(f"{name}.csv", temperature_K)}, files[name])

for name in commands:
    reached_mm = smarig.load_run(files[name]).points()[1][-WANTED_mm.size :]
    error_mm = reached_mm - WANTED_mm
    print(
        f"{name:16s} rms error {np.sqrt(np.mean(error_mm**2)):.3f} mm, largest {np.abs(error_mm).max():.3f} mm"
    )
    print("  " + ", ".join(f"{w:.0f} → {r:.2f}" for w, r in zip(WANTED_mm, reached_mm)))
