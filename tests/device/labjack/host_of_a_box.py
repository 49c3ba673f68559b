"""A host that drives a current through a LabJack until it is killed: ``python host_of_a_box.py URL``."""

import itertools
import sys

from device.labjack.boxes import rig
from smarig.plant import Actuator
from smarig.rig import Bench
from smarig.rig.driver_check import in_role


def main() -> None:
    """Step a bench between two currents, as fast as its clock says."""
    file = rig(sys.argv[1])
    assert file.links is not None
    assert file.simulator is not None
    source = in_role("amplifier", file.links.amplifier, file)
    sensor = in_role("encoder_daq", file.links.encoder_daq, file)
    bench = Bench(file, Actuator.named(file.actuator), source, sensor, speed=file.simulator.speed)
    for k in itertools.count():
        bench.step(0.3 if k // 7 % 2 else 0.5)


if __name__ == "__main__":
    main()
