"""The firmware as a shared library, built once, and fresh devices from it."""

import contextlib

import pytest

from firmware import chips
from firmware.firmware_build import Device, make, open_library
from firmware.uno_emulator import Uno, build

build_folder, start = chips.build_folder, chips.start


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


@pytest.fixture(scope="session")
def uno_folder(tmp_path_factory):
    """The firmware of the Uno and its emulator, built."""
    folder = tmp_path_factory.mktemp("uno")
    build(folder, "uno_emulator")
    build(folder, "uno.elf")
    return folder


@pytest.fixture
def uno(uno_folder, tmp_path):
    """Starts boards; they are closed at the end."""
    with contextlib.ExitStack() as open_boards:

        def begin(*options, **more):
            board = Uno(uno_folder, tmp_path / "trace.txt", *options, **more)
            open_boards.callback(lambda: board.process.poll() is None and board.close())
            return board

        yield begin
