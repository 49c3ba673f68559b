"""A shunt that reads low: the voltage tells, and the current ends before the wire is 10 K above its limit.

The amplifier regulates its own reading, so the true current is a factor larger than ordered and read. All limits of
current and heat rest on that reading.
"""

import os
from itertools import product

import numpy as np
import pytest

from firmware.firmware_build import make as made
from smarig.config import load_rig
from smarig.core import Drive, LimitExceeded, RigFault
from smarig.plant import Actuator, temperature_along
from smarig.rig import Guard, Plausibility, Twin, TwinSettings
from smarig.runner import Session

FACTORS = (1.2, 1.4, 1.9)
MARGIN_K = 10.0
LONG = bool(os.environ.get("SMARIG_LONG"))
CAMPAIGNS = 60 if LONG else 6


class LowShuntRig:
    """A twin whose amplifier drives ``factor(tick)`` times what it reads and was told."""

    def __init__(self, rig, factor, seed):
        file = load_rig(rig)
        strong = file.amplifier.model_copy(update={"saturation_A": 10.0})
        self.file = file.model_copy(update={"amplifier": strong, "kind": "bench"})  # with a bench's tolerance
        self.actuator = Actuator.named(file.actuator)
        self.twin, self._factor = Twin(self.file, self.actuator, TwinSettings(seed=seed)), factor

    def __getattr__(self, name):
        return getattr(self.twin, name)

    def step(self, current_A, at_most=1):
        factor = self._factor(self.twin.tick)
        sample = self.twin.step(factor * current_A)[0]
        return (sample._replace(current_A=sample.current_A / factor, current_command_A=current_A),)


def hottest_K(rig, factor, currents, seed=0):
    """The largest true temperature, and the reason of the trip."""
    lying = LowShuntRig(rig, factor, seed)
    guard = Guard(lying, lying.file.limits, lying.actuator, Plausibility(lying.file, lying.actuator))
    hottest = 0.0
    try:
        for current_A in currents:
            guard.step(float(current_A))
            hottest = max(hottest, *lying.twin.specimen.plant.heating.wire_K)
    except LimitExceeded as trip:
        assert lying.twin.output_A == 0.0
        return hottest, str(trip)
    return hottest, ""


def random_currents(rng, limits):
    levels = rng.uniform(limits.current_min_A, limits.current_max_A, 12)
    levels[rng.integers(12)] = limits.current_max_A
    return np.repeat(levels, rng.integers(20, 300, 12))


@pytest.mark.long("one of each kind", one_of_each=True)
@pytest.mark.parametrize("rig", ["one_wire_twin", "two_wire_twin"])
@pytest.mark.parametrize("factor", FACTORS)
def test_open_loop(rig, factor):
    """From the start, or from a random moment on, in random campaigns."""
    limits, rng = load_rig(rig).limits, np.random.default_rng(5)
    for seed in range(CAMPAIGNS):
        currents = random_currents(rng, limits)
        begins = rng.integers(0, currents.size) if seed % 2 else 0
        hottest, trip = hottest_K(rig, lambda k, b=begins: factor if k >= b else 1.0, currents, seed)
        assert hottest < limits.temperature_max_K + MARGIN_K
        late = begins > currents.size - 100
        assert (
            late or "ohm is outside" in trip or "The voltage is" in trip or "no allowed current needs" in trip
        )


def test_a_drift_is_noticed_at_the_tolerance_of_the_resistance():
    """What no voltage can tell: a shunt within the tolerance. Its heat is the square of its error."""
    held = np.full(6000, 1.0)
    hottest, trip = hottest_K("one_wire_twin", lambda k: 1 + 0.4 * k / 6000, held)
    assert "ohm is outside" in trip or "The voltage is" in trip
    assert hottest < 174.1 * 1.12**2


@pytest.mark.parametrize("factor", FACTORS)
@pytest.mark.parametrize("pattern", [(1.0, 0.0), (0.9, 0.9, 0.04), (0.6, 0.6, 0.6, 0.0)])
def test_a_current_that_pauses_hides_nothing(factor, pattern):
    """Samples without current are no evidence that the shunt is right."""
    hottest, trip = hottest_K("one_wire_twin", lambda _: factor, np.tile(pattern, 400))
    assert trip
    assert hottest < 60.0


@pytest.mark.long("takes a second")
def test_a_right_shunt_does_not_trip():
    rng = np.random.default_rng(6)
    for rig in ("one_wire_twin", "two_wire_twin"):
        for seed in range(3):
            assert hottest_K(rig, lambda _: 1.0, random_currents(rng, load_rig(rig).limits), seed)[1] == ""


# --- over bytes, with the Python devices and with the firmware ---------------------------------------------------


@pytest.fixture(scope="module")
def library(tmp_path_factory):
    return made(tmp_path_factory.mktemp("firmware"), "libsmarig_firmware.so", ("gcc",))


def rig_file(folder, factor, library):
    faults, trace = folder / "faults.toml", folder / "trace.csv"
    faults.write_text(f'[[fault]]\nkind = "low_shunt"\ndevice = "amplifier"\nfactor = {factor}\n')
    chosen = f'library = "{library}"\n' if library else ""
    path = folder / "rig.toml"
    path.write_text(
        'name = "low"\nbase = "one_wire_serial"\namplifier.saturation_A = 10.0\n'
        f'[simulator]\nfaults = "{faults}"\ntrace = "{trace}"\n{chosen}'
    )
    return path, trace


def true_hottest_K(trace):
    flowed_A = np.loadtxt(trace, delimiter=",", skiprows=1, usecols=2) / 1e6
    return temperature_along(Actuator.named("gorbet_one_wire"), flowed_A, 0.1).max(), flowed_A


@pytest.mark.long("takes a second", cases=("firmware-1.4-open",))
@pytest.mark.parametrize(
    ("kind", "factor", "loop"),
    product(("python", "firmware"), FACTORS, ("open", "closed"))
    if LONG
    else [("python", 1.9, "closed"), ("firmware", 1.4, "open")],
)
def test_over_bytes(kind, factor, loop, tmp_path, request):
    path, trace = rig_file(tmp_path, factor, request.getfixturevalue("library") if kind == "firmware" else "")
    low = pytest.raises(RigFault, match=r"ohm is outside|no allowed current needs|resistance|exceeds")
    carry_out = {"open": validated, "closed": closed}[loop]
    with low, Session(str(path)) as session:
        carry_out(session, tmp_path / "low.run.sqlite")
    hottest, flowed_A = true_hottest_K(trace)
    assert 0 < hottest < 185.0 + MARGIN_K
    assert flowed_A[-1] == 0.0


def validated(session, out):
    session.run("validation", {"points": "3"}, out)


def closed(session, out):
    """Towards 11.5 mm by the encoder alone, as a controller would: it raises the current until it is there."""

    def approach(_setup):
        current_A = 0.0
        for _ in range(3000):
            sample = yield Drive(current_A)
            current_A = min(max(current_A + 0.002 * (11.5 - sample.position), 0.0), 1.0)

    session.run("approach", {}, out, protocol_factory=approach)
