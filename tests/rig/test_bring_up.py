"""Bring-up of rigs that do not respond correctly: it reports this and stops heating."""

import random

import numpy as np
import pytest

from rig.lying import TamperedRig
from smarig.config import load_rig
from smarig.core.sample import Quality, Sample
from smarig.plant.actuator import Actuator
from smarig.rig import Twin
from smarig.rig.bring_up import _check_lease, bring_up
from smarig.rig.motion_model import Motion, MotionModel


def checked(change, rig="one_wire_twin"):
    """Checks by name, and the largest current that was driven."""
    driven = [0.0]

    def observed(sample):
        driven.append(abs(lying.twin.output_A))
        return change(sample)

    lying = TamperedRig(rig, observed)
    lying.identity, lying.has_lease, lying.measures_ambient = lambda: ["a twin"], True, True
    checks = []
    bring_up(lying, lying.file, checks.append)
    found = {c.name: c for c in checks}
    assert lying.twin.output_A == 0.0
    return found, max(driven)


def test_what_flows_at_rest_ends_it_before_any_heating():
    found, driven = checked(lambda s: s._replace(current_A=s.current_A + 0.1))
    assert (found["at rest"].passed, list(found)[-1], driven) == (False, "at rest", 0.0)


@pytest.mark.parametrize(("noise_counts", "warned"), [(0.5, False), (2.0, True)])
def test_a_sensor_too_noisy_to_settle_is_named(noise_counts, warned):
    """Resolution as small as the noise of a reading: band_counts is 1, and a block has ten readings."""
    rng = np.random.default_rng(1)
    found, _ = checked(lambda s: s._replace(counts=s.counts + round(rng.normal(0, noise_counts))))
    assert ("settling" in found) == warned
    if warned:
        assert found["settling"].limitation
        assert "check the unit of the driver first; then make encoder.resolution several times the noise" in (
            found["settling"].observed
        )
    assert found["encoder direction"].passed


@pytest.mark.parametrize(
    "change",
    [
        lambda s: s._replace(current_A=0.0),
        lambda s: s._replace(current_A=s.current_A, quality=int(Quality.STALE)) if s.current_A > 0.01 else s,
    ],
)
def test_a_shunt_that_shows_nothing_ends_it_within_the_first_stairs(change):
    found, driven = checked(change)
    assert not found["read-back"].passed
    assert "check the circuit of the wire" in found["read-back"].observed
    assert "lease" not in found
    assert driven <= 0.1 + 1e-9, "of 1 A: two stairs of twenty"


def test_a_room_thermometer_that_cannot_be_right_is_named():
    found, _ = checked(lambda s: s._replace(ambient_degC=500.0))
    check = found["room temperature"]
    assert (check.passed, check.limitation) == (True, True)
    assert check.observed.startswith(
        "The thermometer of the room reads 500 °C, which a room of 22.0 °C with "
    )
    assert found["encoder direction"].passed
    assert "room temperature" not in checked(lambda s: s)[0]


def test_a_source_without_a_voltage_is_reported():
    found, driven = checked(lambda s: s._replace(voltage_V=float("nan")))
    check = found["resistance"]
    assert (check.passed, check.limitation) == (True, True)
    assert "measures no voltage" in check.observed
    assert "an ohmmeter: 4.05 to 5.50 ohm" in check.observed
    assert "lease" in found, "it goes on"
    assert driven > 0.0


def test_an_encoder_that_does_not_count_ends_it_where_the_wire_must_have_moved():
    found, driven = checked(lambda s: s._replace(counts=0))
    assert (found["encoder direction"].passed, list(found)[-1]) == (False, "encoder direction")
    assert "check encoder, coupling" in found["encoder direction"].observed
    assert "its resistance shows that the wire has transformed" in found["encoder direction"].observed
    assert "model_tolerance" not in found["encoder direction"].observed, "no reason to heat it further"
    assert driven <= 0.65, "not all of its 1 A"


def late_wire(tolerance, read=lambda counts, _: counts):
    """Checks by name of a wire that needs twice the heat of its file; the sensor reads (counts, heat in kelvin)."""
    wire = Twin.named("one_wire_twin", noise=False)
    driven = [0.0]

    def late(sample):
        driven.append(abs(lying.twin.output_A))
        wire.step(sample.current_A / np.sqrt(2))
        own = wire.step(sample.current_A / np.sqrt(2))[-1]
        counts = round(read(own.counts, wire.specimen.wire_K[0]))
        return sample._replace(counts=counts, voltage_V=own.voltage_V * np.sqrt(2))

    lying = TamperedRig("one_wire_twin", late)
    lying.identity, lying.has_lease, lying.measures_ambient = lambda: ["a twin"], True, True
    limits = lying.file.limits.model_copy(update={"model_tolerance": tolerance})
    checks = []
    bring_up(lying, lying.file.model_copy(update={"limits": limits}), checks.append)
    assert max(driven) <= limits.current_max_A
    return {c.name: c for c in checks}


@pytest.mark.parametrize(("tolerance", "passed"), [(0.1, False), (0.6, True)])
def test_a_wire_that_transforms_later_is_heated_as_far_as_the_tolerance_says(tolerance, passed):
    """Without any motion the heating ends, too."""
    direction = late_wire(tolerance)["encoder direction"]
    assert direction.passed == passed
    larger = (
        "limits.model_tolerance is 0.1; write a larger one, such as model_tolerance = 0.2, under [limits]"
    )
    assert passed or larger in direction.observed
    assert passed or "check its reference_temperature at reference_current" in direction.observed


@pytest.mark.parametrize("sign", [1, -1])
@pytest.mark.parametrize("tolerance", [0.1, 0.3, 0.6])
def test_what_a_wire_lengthens_before_it_transforms_is_no_motion(sign, tolerance):
    """By 0.1 counts per kelvin, as 0.4 m of wire do: against its direction, and more than noise."""
    found = late_wire(tolerance, lambda counts, wire_K: sign * (counts - 0.1 * wire_K))
    direction = found["encoder direction"]
    assert direction.passed == (sign > 0 and tolerance > 0.1)
    reversed_ = "exchange the encoder's lines" in direction.observed
    assert reversed_ == (sign < 0 and tolerance > 0.1), direction.observed


@pytest.mark.parametrize("factor", [15, 66])
def test_a_scale_that_is_far_too_small_is_seen(factor):
    found, _ = checked(lambda s: s._replace(counts=round(s.counts / factor)))
    assert not found["encoder direction"].passed
    assert "a motion has 8 counts or more" in found["encoder direction"].observed
    assert "heating must" not in found["encoder direction"].observed
    assert "the unit of the driver" in found["encoder direction"].observed


@pytest.mark.parametrize("counts_per_mm", [20, 500, 5000])
def test_a_wire_that_moves_three_times_less_passes_at_any_resolution(counts_per_mm):
    file = load_rig("one_wire_twin")
    scale = counts_per_mm * Actuator.named(file.actuator).resolution(file.encoder)
    lying = TamperedRig("one_wire_twin", lambda s: s._replace(counts=round(scale * s.counts / 3)))
    lying.twin = Twin.named("one_wire_twin", noise=False)
    lying.identity, lying.has_lease, lying.measures_ambient = lambda: ["a twin"], True, True
    encoder = file.encoder.model_copy(update={"resolution": 1 / counts_per_mm, "counts_per_rev": None})
    checks = []
    bring_up(lying, file.model_copy(update={"encoder": encoder}), checks.append)
    assert [c.observed for c in checks if c.name.startswith("encoder") and not c.passed] == []


def test_where_the_current_ends_the_heating_that_is_said():
    lying = TamperedRig("one_wire_twin", lambda s: s._replace(counts=0))
    lying.identity, lying.has_lease, lying.measures_ambient = lambda: ["a twin"], True, True
    limits = lying.file.limits.model_copy(update={"current_max_A": 0.4})
    checks = []
    bring_up(lying, lying.file.model_copy(update={"limits": limits}), checks.append)
    assert "needs more heat than limits.current_max_A" in checks[-1].observed


def test_an_encoder_that_counts_backwards_is_told_from_one_that_does_not_count():
    found, _ = checked(lambda s: s._replace(counts=-s.counts))
    assert not found["encoder direction"].passed
    assert "exchange the encoder's lines" in found["encoder direction"].observed


def test_a_coarse_encoder_is_given_all_the_travel_there_is():
    file = load_rig("one_wire_twin")
    coarse = file.model_copy(update={"encoder": file.encoder.model_copy(update={"counts_per_rev": 50})})
    actuator = Actuator.named(file.actuator)
    enough = [
        [MotionModel(actuator, f, +1).has_shown(Motion(0, False, 0), K) for K in (20, 60, 100, 180)]
        for f in (file, coarse)
    ]
    assert enough == [[False, True, True, True], [False, False, False, True]]


@pytest.mark.parametrize(
    ("counts_per_mm", "factor", "failed"),
    [
        (500, 1, ""),
        (500, 1000, "encoder scale"),  # micrometres
        (500, 1e-3, "encoder direction"),  # metres
        (500, 25.4, "encoder scale"),  # thousandths of an inch, given as 0.001 mm
        (20, 1, ""),
        (20, 1000, "encoder scale"),
        (20, 1e-3, "encoder direction"),
        (20_000, 1e-3, "encoder direction"),
        (1 / 15, 1000, "encoder scale"),  # micrometres, with a resolution chosen for their noise
    ],
)
def test_a_position_in_another_unit_than_the_file_says_is_seen(counts_per_mm, factor, failed):
    file = load_rig("one_wire_twin")
    scale = counts_per_mm * Actuator.named(file.actuator).resolution(file.encoder)

    def read(sample):
        return sample._replace(counts=round(scale * factor * sample.counts))

    lying = TamperedRig("one_wire_twin", read)
    lying.twin = Twin.named("one_wire_twin", noise=False)
    lying.identity, lying.has_lease, lying.measures_ambient = lambda: ["a twin"], True, True
    resolution = file.encoder.model_copy(update={"resolution": 1 / counts_per_mm, "counts_per_rev": None})
    checks = []
    bring_up(lying, file.model_copy(update={"encoder": resolution}), checks.append)
    wrong = [check for check in checks if check.name.startswith("encoder") and not check.passed]
    assert [check.name for check in wrong] == ([failed] if failed else [])
    assert not failed or "the unit of the driver" in wrong[0].observed


@pytest.mark.parametrize("factor", [1, -1])
@pytest.mark.parametrize("seed", range(4))
def test_the_noise_of_a_sensor_in_micrometres_is_no_direction(factor, seed):
    """Its noise is a thousand times larger, too: larger than what the first steps move the wire."""
    dice, file = random.Random(seed), load_rig("one_wire_twin")
    resolution_mm = 0.002
    scale = Actuator.named(file.actuator).resolution(file.encoder) / resolution_mm

    def read(sample):
        return sample._replace(counts=round(1000 * factor * (scale * sample.counts + dice.gauss(0.0, 1.0))))

    lying = TamperedRig("one_wire_twin", read)
    lying.twin = Twin.named("one_wire_twin", noise=False)
    lying.identity, lying.has_lease, lying.measures_ambient = lambda: ["a twin"], True, True
    encoder = file.encoder.model_copy(update={"resolution": resolution_mm, "counts_per_rev": None})
    checks = []
    bring_up(lying, file.model_copy(update={"encoder": encoder}), checks.append)
    assert [check.name for check in checks if not check.passed] == ["encoder scale"]


@pytest.mark.parametrize("moved_um", [0.0, 2.0])
def test_noise_that_hides_the_least_motion_names_the_unit_before_any_heating(moved_um):
    """A quiet laser that reads um as mm, on a wire that has lengthened by next to nothing: neither direction nor scale
    was seen.
    """
    dice, per_count = random.Random(2), 12.5 / 260  # mm, about

    def read(sample):
        read_mm = moved_um * (sample.current_A > 0.1) + dice.gauss(0.0, 0.27)
        return sample._replace(counts=round(read_mm / per_count))

    found, driven = checked(read)
    scale = found["encoder scale"]
    assert (scale.passed, list(found)[-1], driven) == (False, "encoder scale", 0.0)
    assert "settling" not in found, "no advice to choose a resolution"
    assert "% of the stroke of 12." in scale.observed
    assert "readings at rest scatter by" in scale.observed
    assert scale.observed.index("a sensor in um read as mm?") < scale.observed.index("encoder.resolution")


@pytest.mark.parametrize(("read", "limited"), [(1.0, False), (0.2, True), (5.0, True)])
def test_a_motion_far_from_its_model_asks_for_a_gauge(read, limited):
    """Such as that of a late wire whose few um are read as mm, by a sensor without noise."""
    lying = TamperedRig("one_wire_twin", lambda s: s._replace(counts=round(read * s.counts)))
    lying.twin = Twin.named("one_wire_twin", noise=False)
    lying.identity, lying.has_lease, lying.measures_ambient = lambda: ["a twin"], True, True
    checks = []
    bring_up(lying, lying.file, checks.append)
    found = {c.name: c for c in checks}
    scale = found["encoder scale"]
    assert (scale.passed, scale.limitation) == (True, limited)
    assert "(accepted: 8 to " in scale.observed
    assert "as a wire may transform later than its model)" in scale.observed
    assert ("compare its readings with a gauge" in scale.observed) == limited
    assert found["encoder direction"].passed


def test_both_wires_are_looked_at():
    """The heating of wire 2 must decrease the counts: first its diode blocks, then it counts upwards."""
    found, _ = checked(lambda s: s._replace(current_A=max(s.current_A, 0.0)), "two_wire_twin")
    assert found["encoder direction"].passed
    assert list(found)[-1] == "read-back, wire 2"
    found, _ = checked(lambda s: s._replace(counts=abs(s.counts)), "two_wire_twin")
    assert list(found)[-1] == "encoder direction, wire 2"
    assert "must decrease the counts" in found["encoder direction, wire 2"].observed


def test_a_source_without_a_lease_is_reported():
    lying = TamperedRig("one_wire_twin", lambda s: s)
    lying.identity, lying.has_lease, lying.measures_ambient = lambda: ["a supply"], False, False
    checks = []
    bring_up(lying, lying.file, checks.append)
    last = checks[-1]
    assert (last.name, last.passed) == ("lease", True)
    assert "only the cut-out stops the current" in last.observed
    assert "22.0 °C by the rig file (not measured)" in next(c for c in checks if c.name == "at rest").observed


class Leased:
    """A device that continues without commands, trips in time, and then carries ``left_A``."""

    period_s, lease_ticks, counts_ticks = 0.1, 10, True

    def __init__(self, left_A):
        self._left_A = left_A
        self._tick, self._unfed, self._armed = 0, 0, True
        self._ring = []

    def _live(self, current_A):
        self._tick, self._unfed = self._tick + 1, self._unfed + 1
        self._armed = self._armed and self._unfed <= self.lease_ticks
        mark = Quality.GOOD if self._armed else Quality.TRIPPED
        flows_A = current_A if self._armed else self._left_A
        nan = float("nan")
        self._ring.append(
            Sample(self._tick, 0.1 * self._tick, current_A, flows_A, nan, nan, 0, 0.0, nan, int(mark))
        )

    def idle(self, seconds):
        for _ in range(round(seconds / self.period_s)):
            self._live(0.1)

    def arm(self):
        self._armed, self._unfed = True, 0

    def step(self, current_A):
        self._unfed = 0
        self._live(current_A)
        samples, self._ring = self._ring[:16], self._ring[16:]
        return tuple(samples)


@pytest.mark.parametrize(("left_A", "passes"), [(0.0, True), (0.1, False)])
def test_a_lease_that_trips_with_current_still_flowing_fails(left_A, passes):
    lease, re_arm = _check_lease(Leased(left_A), load_rig("one_wire_twin"))
    assert (lease.passed, re_arm.passed) == (passes, True), lease
    assert ("0.1000 A flowed after the trip" in lease.observed) != passes


def test_a_lease_that_never_acts_fails_in_words():
    rig = Leased(0.1)
    rig.lease_ticks = 10**6
    lease, _ = _check_lease(rig, load_rig("one_wire_twin"))
    assert not lease.passed
    assert "the output did not switch off; lease" in lease.observed


def test_where_ticks_are_not_counted_the_moment_is_that_of_the_question():
    rig = Leased(0.0)
    rig.counts_ticks = False
    lease, _ = _check_lease(rig, load_rig("one_wire_twin"))
    assert lease.passed
    assert lease.observed.startswith("the output was off when it was asked ")


@pytest.mark.parametrize(("held", "measured_K"), [(False, 1.0), (True, 1.0), (False, float("nan"))])
def test_where_the_host_alone_limits_a_measured_wire_temperature_it_is_said(held, measured_K):
    rig = TamperedRig(
        "one_wire_twin", lambda s: s._replace(temperature_degC=s.ambient_degC + measured_K, current_A=0.0)
    )
    rig.identity, rig.has_lease, rig.holds_wire_limit = lambda: ["a twin"], True, held
    rig.measures_ambient = True
    checks = []
    bring_up(rig, rig.file, checks.append)
    said = [c for c in checks if c.name == "wire temperature"]
    if held or measured_K != measured_K:
        assert not said
    else:
        assert [(c.passed, c.limitation) for c in said] == [(True, True)]
        assert said[0].observed.startswith("The host alone holds the limit of the measured wire temperature")


def test_a_wire_of_another_resistance_is_heated_no_further_than_two_readings_need():
    """Its heat is not that of the model, whatever the file says."""
    found, driven = checked(lambda s: s._replace(voltage_V=1.7 * s.voltage_V))
    assert not found["resistance"].passed
    assert "another wire has an actuator file of its own" in found["resistance"].observed
    assert driven <= 0.15


def test_wrong_voltages_in_one_step_end_nothing():
    """The last reading of a step is compared: here that of one step in the middle is wrong."""
    found, driven = checked(
        lambda s: s._replace(voltage_V=s.voltage_V * (3.0 if 0.19 < s.current_command_A < 0.21 else 1.0))
    )
    assert driven > 0.25
    assert found["resistance"].passed
    assert found["encoder direction"].passed
