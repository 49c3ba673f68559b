"""Closed loops over real bytes equal those of the twin in process, sample by sample, and are safe on loss of
the link.

On one wire every controller runs on every link; on two, which take three times as long, one controller of each kind, or
all with ``SMARIG_LONG=1``.
"""

import os
from functools import cache

import numpy as np
import pytest

from control.model_files import model_of
from rig.bench.broken_rig import LEASE_S, rig_file
from smarig.certificate.certify_hysteresis import certificate
from smarig.certificate.rig_assessment import RigAssessment
from smarig.config import load_rig
from smarig.control.controller_settings import TRACKING_CONTROLLERS, VELOCITY_CONTROLLERS, default_numbers
from smarig.control.regulation import regulate
from smarig.control.tracking import ControllerModel, reference, track
from smarig.control.tracking.tuning import controller_factory
from smarig.control.velocity.velocity_protocol import velocity_feedback
from smarig.core.catalogue import catalogue_entry, catalogue_names
from smarig.core.command import Drive, Settled
from smarig.core.errors import SmarigError
from smarig.preisach.hysteresis.gorbet_1997 import thesis_surface
from smarig.protocols._setup import Setup
from smarig.record import load_run
from smarig.runner.preview import Preview
from smarig.runner.session import Session

POSITION, VELOCITY = (
    catalogue_names(TRACKING_CONTROLLERS),
    catalogue_names(VELOCITY_CONTROLLERS),
)
ON_TWO_WIRES = (POSITION, VELOCITY) if os.environ.get("SMARIG_LONG") else (POSITION[:1], VELOCITY[:1])
COLUMNS = (
    "tick",
    "t_s",
    "current_command_A",
    "current_A",
    "voltage_V",
    "counts",
    "position",
    "quality",
    "input",
)
KNOWN_COST = Preview("track", 20.0, 0, 1.0, 150.0, 0, 1)  # previews are not what is tested here
LOST_S, PERIOD_S = 12.0, 0.1  # into a step upwards


def following(name, rig):
    """A controller along 20 s of steps, from where the wire is."""
    file = load_rig(rig)

    def make(setup):
        controller_model = ControllerModel(
            setup,
            thesis_surface("two_e" if setup.two_wire else "one_e"),
            setup.actuator.resolution(file.encoder),
        )
        low, high = controller_model.reach
        places = (low + 0.3 * (high - low), low + 0.6 * (high - low))
        follow = reference("steps", *places, seconds=20.0, every_s=5.0, seed=1)
        return track(
            controller_model,
            controller_factory(name, default_numbers(TRACKING_CONTROLLERS, name)),
            follow,
            name=name,
            prepare=False,
        )

    return make


def velocity_following(name, rig):
    """A velocity controller along 10 s up and down from where the wire is; what is proved is computed beforehand."""
    setup = Setup.of(rig)
    model = model_of("two_e" if setup.two_wire else "one_e")
    (proved,) = certificate(model.hysteresis, {name: {}}).controllers
    assess = RigAssessment(proved, setup, 10 * setup.period_s).to_json

    def make(setup):
        yield Drive(0.0)
        yield from velocity_feedback(
            setup,
            catalogue_entry(VELOCITY_CONTROLLERS, name)(),
            [0.6] * 60 + [-0.3] * 40,
            20.0,
            assess=assess,
        )

    return make


def holding(setup):
    """A set-point held from an outer branch, with short holds before."""
    quick = Settled(window_s=1.0, timeout_s=2.0, approach_K=100.0, band_counts=400.0)
    return regulate(
        setup, hysteresis=thesis_surface("one_e"), setpoint=6.0, start="ascending", hold_s=20.0, settle=quick
    )


def recorded(rig, folder, wire):
    """The controllers in one session."""
    position, velocity = ON_TWO_WIRES if rig.startswith("two") else (POSITION, VELOCITY)
    loops = {name: following(name, rig) for name in position}
    loops |= {name: velocity_following(name, rig) for name in velocity}
    with Session(rig, seed=3, wire=wire) as session:
        return {
            name: load_run(
                session.run(
                    "track",
                    {},
                    folder / f"{name}.run.sqlite",
                    expected=KNOWN_COST,
                    protocol_factory=loop,
                )
            )
            for name, loop in loops.items()
        }


@pytest.fixture(scope="module")
def twin(tmp_path_factory):
    """The runs of a twin in process; each is made when it is asked for."""

    @cache
    def of(arrangement):
        return recorded(f"{arrangement}_wire_twin", tmp_path_factory.mktemp(arrangement), "in process")

    return of


@pytest.mark.long("takes three seconds", cases=("two_wire_serial",))
@pytest.mark.parametrize(
    "link",
    [
        pytest.param("one_wire_serial", marks=pytest.mark.long),
        pytest.param("one_wire_modbus_tcp", marks=pytest.mark.long),
        pytest.param("one_wire_modbus_rtu", marks=pytest.mark.long),
        "two_wire_serial",
    ],
)
def test_bytes_make_no_difference_to_any_controller(twin, link, tmp_path):
    runs = recorded(link, tmp_path, link)
    for name, same in twin(link[:3]).items():
        assert np.ptp(same["position"]) > 0.5, "it moves"
        assert np.unique(same["current_command_A"]).size > 20, "it is a loop"
        for column in COLUMNS:
            np.testing.assert_array_equal(runs[name][column], same[column], err_msg=f"{name}, {column}")
        marks = [[(e.text, e.data) for e in run.events if e.kind == "mark"] for run in (runs[name], same)]
        assert marks[0] == marks[1], "k_e, the measured ratio and the hypotheses, too"


LOSSES = [
    pytest.param("serial", "gain_scheduled", "amplifier", "dead_line", marks=pytest.mark.long),
    ("modbus_tcp", "inverse", "amplifier", "unplugged"),
    ("modbus_rtu", "pi", "encoder_daq", "dead_line"),
    pytest.param(
        "modbus_rtu", "regulate", "amplifier", "dead_line", marks=pytest.mark.long("takes ten seconds")
    ),
]


@pytest.mark.long(
    "takes a second", cases=("modbus_rtu-pi-encoder_daq-dead_line", "modbus_tcp-inverse-amplifier-unplugged")
)
@pytest.mark.parametrize(("link", "name", "device", "loss"), LOSSES)
def test_a_link_lost_in_mid_loop_ends_at_zero_current(link, name, device, loss, tmp_path):
    rig = rig_file(tmp_path, link, [{"kind": loss, "device": device, "from_s": LOST_S}])
    out = tmp_path / "r.run.sqlite"
    protocol_factory = holding if name == "regulate" else following(name, str(rig))
    with (
        pytest.raises(SmarigError, match=f"{device} cannot be reached") as ended,
        Session(str(rig)) as session,
    ):
        session.run("loop", {}, out, expected=KNOWN_COST, protocol_factory=protocol_factory)
    assert ended.value.exit_status == 3
    run = load_run(out)
    assert run.cause.startswith("stopped: ")
    labels = [e.text for e in run.events if e.kind == "mark"]
    assert labels[-1] in ("closed loop", "loop closed"), "the loop was closed, and never opened"
    tick, output_uA = np.loadtxt(tmp_path / "trace.csv", delimiter=",", skiprows=1, usecols=(0, 2), ndmin=2).T
    flowing = tick[output_uA != 0]
    assert flowing[-1] >= LOST_S / PERIOD_S - 1, "current flowed when it was lost"
    assert output_uA[-1] == 0
    assert flowing[-1] <= (LOST_S + LEASE_S) / PERIOD_S + 1
