"""The firmware's programs, each under the emulator of its architecture: an AVR under simavr, a Cortex-M3 under QEMU."""

import subprocess

from firmware.chip import Chip
from firmware.firmware_build import make

AVR = ("avr-gcc", "avr-nm")
SIMAVR = ("gcc", "/usr/include/simavr/sim_avr.h", "/usr/include/libelf.h")
# QEMU does not end by itself when its parent is killed: setpriv of util-linux sees to that
CORTEX_M = ("arm-none-eabi-gcc", "arm-none-eabi-size", "qemu-system-arm", "setpriv")
# in real time: with -icount sleep=off device time runs 40 times too fast, with shift=auto exchanges were lost
QEMU = ("setpriv", "--pdeathsig", "TERM", "qemu-system-arm", "-M", "lm3s6965evb", "-display", "none")
SERIAL = ("-chardev", "pty,id=line", "-serial", "chardev:line")
PLANT = ("-chardev", "stdio,id=plant,signal=off", "-serial", "chardev:plant")


def avr(folder, name, world, watched=False):
    """A chip of ``avr/``, by the name of its program. Its time is its own: a watchdog needs no care."""
    del watched
    elf = make(folder, f"{name}.elf", AVR)
    runner = make(folder, "runner", SIMAVR)
    symbols = subprocess.run(["avr-nm", elf], capture_output=True, text=True, check=True).stdout
    plant = next(line.split()[0] for line in symbols.splitlines() if line.endswith(" plant"))
    return Chip([runner, elf, plant], world, ends_itself=True)


def cortex_m(folder, name, world, watched=False):
    """A chip of ``cortex_m/``, by the name of its program.

    QEMU's watchdog counts real time, so a busy machine looks like a program that hangs: it acts if ``watched``.
    """
    elf = make(folder, f"cortex_m_{name}.elf", CORTEX_M)
    action = ("-action", f"watchdog={'reset' if watched else 'none'}")
    command = [*QEMU, "-monitor", "none", "-net", "none", *SERIAL, *PLANT, *action, "-kernel", elf]
    return Chip(command, world, ends_itself=False)


ARCHITECTURES = {"avr": avr, "cortex_m": cortex_m}
