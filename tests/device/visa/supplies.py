"""Simulated supplies, and rig files whose devices they are."""

from simulators.supply_bench import SupplyBench
from smarig.config import load_rig
from smarig.rig import TwinSettings

SPEED = 40.0  # device seconds per second

RIG = """name = "visa"
base = "laboratory_supply"
wire = "twin-of-a-test"
period_s = 0.1
lease_s = {lease}
encoder.resolution = 0.01
[links.amplifier]
driver = "visa_supply"
framing = "lines"
url = "{supply}"
timeout_s = 1.0
settings = {{ backend = "@py" }}
[links.encoder_daq]
driver = "visa_meter"
framing = "lines"
url = "{meter}"
timeout_s = 1.0
settings = {{ backend = "@py", query = "READ?", unit = "mm" }}
[simulator]
start = false
speed = {speed}
"""


def bench_of(make, path, lease_s, speed=SPEED):
    """The simulated devices of a rig file that is written to ``path``."""
    path.write_text(RIG.format(supply="", meter="", speed=speed, lease=lease_s))
    bench = SupplyBench(load_rig(str(path)), TwinSettings(seed=1), make, speed)
    urls = {"supply": bench.urls["amplifier"], "meter": bench.urls["encoder_daq"]}
    path.write_text(RIG.format(**urls, speed=speed, lease=lease_s))
    return bench
