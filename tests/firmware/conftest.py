"""The firmware as a shared library, built once, and fresh devices from it."""

import contextlib

import pytest

from firmware.chip import AVR, SIMAVR, Chip
from firmware.firmware_build import Device, make, open_library


@pytest.fixture(scope="session")
def build_folder(tmp_path_factory):
    return tmp_path_factory.mktemp("firmware")


@pytest.fixture(scope="session")
def library(build_folder):
    return open_library(make(build_folder, "libsmarig_firmware.so", ("gcc",)))


@pytest.fixture
def amp(library):
    """An amplifier with room to move: 2 A, no rate or heat that matters, ticks of 100 ms."""
    device = Device(library, "amplifier")
    wide = {"slew_max": 1_000_000, "heat_max": 2**32 - 1}
    assert device.settings(current_min=-2_000_000, current_max=2_000_000, **wide) == 0
    return device


@pytest.fixture
def daq(library):
    return Device(library, "encoder_daq")


@pytest.fixture
def start(build_folder):
    """Starts a chip by the name of its program."""
    with contextlib.ExitStack() as open_chips:

        def begin(name, world):
            elf = make(build_folder, f"{name}.elf", AVR)
            chip = Chip(make(build_folder, "runner", SIMAVR), elf, world)
            open_chips.callback(chip.close)
            return chip

        yield begin
