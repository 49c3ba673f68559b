"""A meter on a TCP port that answers one query with a number."""

from collections.abc import Callable

from simulators.text_server import TextServer

OVERLOAD = 9.9e37  # as meters answer
LARGEST = 1e9


class SimulatedMeter(TextServer):
    """``value`` is what it measures, in the unit of its answer; commands without an answer are accepted."""

    def __init__(self, query: str, value: Callable[[], float], identity: str = "smarig,meter,1,0") -> None:
        self.identity, self.value, self._query = identity, value, query.upper()
        super().__init__()

    def answer(self, line: str) -> str | None:
        """A number to the query, a name to ``*IDN?``."""
        match line.upper():
            case "*IDN?":
                return self.identity
            case self._query:
                value = self.value()
                return f"{value if abs(value) < LARGEST else OVERLOAD:.7E}"
        return None
