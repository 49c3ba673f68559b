"""A device behind a register map on a line: its map, its conversation, and what a rig asks of every device."""

from smarig.device.drivers._conversation import Conversation
from smarig.device.encoding.register import load_register_map
from smarig.device.links.link import Link


class LineDevice:
    """A device by the name of its register map. ``talk`` is the conversation with it."""

    def __init__(self, link: Link, name: str) -> None:
        self.map = load_register_map(name)
        self.talk = Conversation(link, self.map)

    @property
    def reconnections(self) -> int:
        """How often its line was lost and opened again."""
        return self.talk.reconnections

    @property
    def identity(self) -> str:
        """The device, its map and its number of starts."""
        return self.talk.identity
