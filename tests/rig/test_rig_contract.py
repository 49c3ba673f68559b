"""The rig contract on every rig: twins in process, benches over each link, the C firmware on this machine."""

import contextlib

import pytest

from firmware.firmware_build import make as made
from rig.rig_contract import CHECKS
from smarig.config import load_rig
from smarig.plant.actuator import Actuator
from smarig.rig.open_rig import open_rig
from smarig.rig.twin import TwinSettings

OF_BOTH_KINDS = pytest.mark.long("takes ten seconds; each half of it is tried on another rig")
RIGS = [
    *("one_wire_twin", "two_wire_twin", "one_wire_thermomechanical"),
    pytest.param("two_wire_thermomechanical", marks=OF_BOTH_KINDS),
    "one_wire_modbus_tcp",
    *(pytest.param(f"one_wire_{link}", marks=OF_BOTH_KINDS) for link in ("serial", "modbus_rtu")),
    *("firmware one_wire_serial", "firmware one_wire_modbus_rtu"),
]
LEASE_S = 0.5  # the shortest: tests of it take as long


@pytest.fixture(scope="session")
def library(tmp_path_factory):
    return made(tmp_path_factory.mktemp("firmware"), "libsmarig_firmware.so", ("gcc",))


@pytest.fixture(params=RIGS)
def make(request, tmp_path):
    kind, _, name = request.param.rpartition(" ")
    text = [f'name = "contract"\nbase = "{name}"\nlease_s = {LEASE_S}\n']
    if kind:
        text.append(f'[simulator]\nlibrary = "{request.getfixturevalue("library")}"\n')
    path = tmp_path / "contract.toml"
    path.write_text("".join(text))
    file = load_rig(str(path))
    actuator = Actuator.named(file.actuator)
    with contextlib.ExitStack() as open_:
        yield lambda seed=0: open_.enter_context(open_rig(str(path), file, actuator, TwinSettings(seed=seed)))


@pytest.mark.long(
    "takes three seconds",
    cases=(
        "firmware one_wire_modbus_rtu-in_lock_step_the_same_seed_gives_the_same_samples",
        "firmware one_wire_modbus_rtu-it_moves",
        "firmware one_wire_serial-alarms_are_reported_once_and_closing_is_harmless",
        "firmware one_wire_serial-in_lock_step_the_same_seed_gives_the_same_samples",
        "firmware one_wire_serial-it_moves",
        "one_wire_modbus_tcp-in_lock_step_the_same_seed_gives_the_same_samples",
    ),
)
@pytest.mark.parametrize("check", CHECKS, ids=lambda check: check.__name__.removeprefix("check_"))
def test_every_rig(check, make):
    check(make)
