"""Fixtures: a folder to build in, and chips that are started by the name of their program."""

import contextlib

import pytest

from firmware.architectures import ARCHITECTURES


@pytest.fixture(scope="session")
def build_folder(tmp_path_factory):
    return tmp_path_factory.mktemp("firmware")


@pytest.fixture(params=ARCHITECTURES)
def start(request, build_folder):
    """Starts a chip of an architecture by the name of its program."""
    with contextlib.ExitStack() as open_chips:

        def begin(name, world, **more):
            chip = ARCHITECTURES[request.param](build_folder, name, world, **more)
            open_chips.callback(chip.close)
            return chip

        yield begin
