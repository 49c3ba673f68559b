"""One address for each instrument of VISA, however it is written (VPP-4.3, section 4.3: address strings).

    GPIB[0]::24[::SECONDARY][::INSTR]                   visa://gpib0/24
    TCPIP[0]::HOST[::inst0 or hislip0][::INSTR]         visa://HOST/0
    TCPIP[0]::HOST::PORT::SOCKET                        tcp://HOST:PORT
    USB[0]::0x1AB1 or 6833::PRODUCT::SERIAL[::INSTR]    visa://usb/6833/PRODUCT/SERIAL
    ASRL/dev/ttyUSB0[::INSTR]                           /dev/ttyUSB0

Upper and lower case are equal, and a board that is not given is 0.
"""

import os
import re

_FIELDS = re.compile(r"::(?![^\[]*\])")  # an IPv6 address stands in brackets
_INTERFACE = re.compile(r"([a-z-]+)(\d*)")
_LAN_DEVICE = re.compile(r"(?:inst|hislip)(\d+)(?:,\d+)?")  # by VXI-11 or HiSLIP: the same device
_CLASSES = ("instr", "raw", "intfc", "backplane", "memacc", "servant")


def canonical_address(url: str) -> str:
    """The address of an instrument, or of the port or socket that VISA opens. Any other address stays as it is.

    >>> canonical_address("gpib::24"), canonical_address("TCPIP::10.0.0.5::inst0::INSTR"), canonical_address("Dev1")
    ('visa://gpib0/24', 'visa://10.0.0.5/0', 'Dev1')
    """
    text = url.strip()
    if "://" in text:
        return url
    if text[:4].upper() == "ASRL":
        return _port(_FIELDS.split(text[4:])[0])
    interface, *fields = _FIELDS.split(text.lower())
    name = _INTERFACE.fullmatch(interface)
    if name is None or not fields:
        return url
    kind, board = name[1], name[2] or "0"
    if kind == "tcpip" and fields[-1] == "socket" and len(fields) > 2:
        return f"tcp://{fields[0]}:{fields[1]}"
    fields = fields[:-1] if fields[-1] in _CLASSES else fields
    if kind == "tcpip":
        device = fields[1] if len(fields) > 1 else "inst0"
        number = _LAN_DEVICE.fullmatch(device)
        return f"visa://{fields[0]}/{number[1] if number else device}"
    if kind == "usb":  # at whichever board, through whichever interface of the instrument
        return "/".join(["visa://usb", *map(_number, fields[:2]), *fields[2:3]])
    return "/".join([f"visa://{kind}{_number(board)}", *map(_number, fields)])


def _port(name: str) -> str:
    """The serial port of what follows ASRL: its path, its name, or the number of a built-in port."""
    if not name.isdecimal():
        return name
    return f"COM{name}" if os.name == "nt" else f"/dev/ttyS{_number(name)}"


def _number(text: str) -> str:
    """A number, decimal or hexadecimal; any other text stays."""
    try:
        return str(int(text, 16 if text.startswith("0x") else 10))
    except ValueError:
        return text
