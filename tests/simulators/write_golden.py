"""Writes firmware_protocol/golden. The expected replies are in golden_*.py, written by hand from the
protocol alone."""

import sys
from pathlib import Path

if __name__ == "__main__":
    sys.path.insert(0, str(Path(__file__).resolve().parents[2]))

from golden import FOLDER
from golden_orders import board, epoch, nonce, outputs
from golden_rings import daq_ring, daq_work, ring
from golden_safety import contacts, heat, lease, slew, trips, wire_temperature
from golden_talking import frames, handshake, repeats, settings, text, work

SCRIPTS = (
    *(handshake, frames, text, settings, work, repeats),
    *(nonce, epoch, outputs, board),
    *(lease, trips, contacts, slew, heat, wire_temperature),
    *(ring, daq_work, daq_ring),
)

if __name__ == "__main__":
    for make in SCRIPTS:
        make().write(FOLDER)
