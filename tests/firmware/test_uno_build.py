"""The program fits the ATmega328P, and another largest current is another program."""

import re
import subprocess

import pytest

from firmware.uno_emulator import NEEDS, UNO, build

FLASH, BOOTLOADER, RAM = 32768, 512, 2048
STACK = 350  # bytes; test_uno_fuzz measures what is left of it


def sizes(elf):
    """Bytes of flash and of RAM that the variables take."""
    told = subprocess.run(["avr-size", elf], capture_output=True, text=True, check=True).stdout
    text, data, bss = map(int, told.splitlines()[1].split()[:3])
    return text + data, data + bss


@pytest.mark.long("takes two seconds")
def test_it_fits(uno_folder):
    flash, ram = sizes(uno_folder / "uno.elf")
    assert flash <= FLASH - BOOTLOADER
    assert ram <= RAM - STACK


def test_it_can_be_flashed(uno_folder):
    hexfile = build(uno_folder, "uno.hex").read_text("ascii").splitlines()
    assert all(re.fullmatch(r":[0-9A-F]+", line) for line in hexfile)
    said = subprocess.run(
        ["make", "-n", "-C", str(UNO), f"OUT={uno_folder}", "PORT=/dev/ttyX", "flash"],
        capture_output=True,
        text=True,
        check=True,
    ).stdout
    assert "avrdude -p atmega328p -c arduino -P /dev/ttyX -b 115200" in said


@pytest.mark.long("takes two seconds")
def test_another_largest_current_is_another_program(tmp_path):
    before = build(tmp_path, "uno.elf").read_bytes()
    assert build(tmp_path, "uno.elf", "BOARD_MAX_uA=500000").read_bytes() != before
    assert NEEDS


@pytest.mark.long("takes three seconds")
def test_the_largest_current_of_a_board_is_kept_by_later_builds(tmp_path):
    small = build(tmp_path, "uno.elf", "BOARD_MAX_uA=500000").read_bytes()
    assert build(tmp_path, "uno.elf").read_bytes() == small
