"""The receiver of the firmware's programs, built for this machine: what an interrupt in a bad moment leaves behind."""

import ctypes
import shutil
import subprocess

import pytest

from firmware.firmware_build import FIRMWARE

# In place of the hardware, and of switching interrupts off.
STAND_IN = """
#define SMARIG_ATOMIC_H
#define ATOMICALLY
"""
HARDWARE = """
void serial_start(void) {}
void serial_send(void) {}
void silence_start(void) {}
void silence_restart(void) {}
"""


@pytest.fixture
def link(tmp_path):
    if shutil.which("gcc") is None:
        pytest.skip("gcc is not installed")
    (tmp_path / "stand_in.h").write_text(STAND_IN)
    (tmp_path / "hardware.c").write_text(HARDWARE)
    library = tmp_path / "link.so"
    sources = [FIRMWARE / "program" / "link.c", tmp_path / "hardware.c"]
    defined = ["-DFRAMING_rtu", "-DDEVICE_encoder_daq", "-include", tmp_path / "stand_in.h"]
    subprocess.run(["gcc", "-shared", "-fPIC", "-Wall", *defined, "-o", library, *sources], check=True)
    return ctypes.CDLL(str(library))


def request(link, data=b""):
    """What the main loop sees after these bytes and a silence."""
    for byte in data:
        link.link_byte(byte, False)
    link.link_silence()
    return link.link_request(ctypes.byref(ctypes.c_void_p()))


def test_a_silence_after_nothing_does_not_deafen_it(link):
    """A byte that comes in the moment a silence ends starts another one, which then ends after the request is gone."""
    assert request(link, b"\x64\x03") == 2
    link.link_reply(0)
    assert request(link) == 0
    assert request(link, b"\x64\x03\x01") == 3
