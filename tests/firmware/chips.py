"""Fixtures: a folder to build in, and chips that are started by the name of their program."""

import contextlib

import pytest

from firmware.chip import AVR, SIMAVR, Chip
from firmware.firmware_build import make


@pytest.fixture(scope="session")
def build_folder(tmp_path_factory):
    return tmp_path_factory.mktemp("firmware")


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
