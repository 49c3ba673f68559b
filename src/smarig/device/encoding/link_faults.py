"""Faults between host and device, by cause, each with its remedy."""

from smarig.core import RigFault

_NETWORK = ("tcp://", "socket://", "TCPIP")  # addresses that begin so, TCPIP in VISA


class LinkFault(RigFault):
    """A fault of a link."""


class Silent(LinkFault):
    """No reply in time. Causes: cable, power, port, or a device that hangs."""

    remedy = "Check its power, the cable and the port, and whether another program uses it."


class Garbled(LinkFault):
    """Bytes arrived, but no complete frame. Causes: noise, another baud rate, another device."""

    remedy = "Check baud rate and framing in the rig file, the shielding and the ground."
    network_remedy = "Check its manual for the form of this reply, and whether another program uses it."

    @classmethod
    def remedy_at(cls, where: str) -> str:
        """The remedy that fits an address: a network has no baud rate.

        >>> Garbled.remedy_at("tcp://192.168.1.30:5025") == Garbled.network_remedy
        True
        """
        return cls.network_remedy if where.startswith(_NETWORK) else cls.remedy


class Stale(LinkFault):
    """A complete reply to another request than the last."""

    remedy = "Check whether a second program uses the device or a gateway delays replies."


class Refused(LinkFault):
    """The device refused a request that it received correctly. ``code``: see firmware_protocol/README.md."""

    def __init__(self, text: str, code: int) -> None:
        super().__init__(text)
        self.code = code


class WrongDevice(LinkFault):
    """A device of another kind replies on this link."""


class WrongMap(LinkFault):
    """The device's firmware has another register map than this smarig."""


class Rebooted(LinkFault):
    """The device restarted: brown-out, watchdog reset, or its power switch."""
