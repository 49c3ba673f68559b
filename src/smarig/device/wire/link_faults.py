"""What can go wrong between host and device, by blame, each with what to do. Knows no device and no link."""

from smarig.core import RigFault


class LinkFault(RigFault):
    """Something went wrong on a link."""


class Silent(LinkFault):
    """Nothing was said in time: cable, power, port, or a device that hangs."""

    remedy = "Check its power, the cable and the port; is another program using it?"


class Garbled(LinkFault):
    """Something was said, but no whole frame: noise, another baud rate, another device."""

    remedy = "Check baud rate and framing in the rig file, shielding and ground."


class Stale(LinkFault):
    """A whole reply, but to another request than the last."""

    remedy = "Is a second program talking to the device, or a gateway that keeps replies back?"


class Refused(LinkFault):
    """The device understood and said no: ``code`` as in firmware_protocol/README.md."""

    def __init__(self, text: str, code: int) -> None:
        super().__init__(text)
        self.code = code


class WrongDevice(LinkFault):
    """Another kind of device answers at this link."""


class WrongMap(LinkFault):
    """The device's firmware has another register map than this smarig."""


class Rebooted(LinkFault):
    """The device started anew: brown-out, watchdog or a hand at the switch."""
