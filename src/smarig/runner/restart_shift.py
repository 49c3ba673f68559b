"""Converts ticks and counts of a restarted device to those of an earlier record."""

from dataclasses import dataclass

from smarig.core import Sample


@dataclass
class Shift:
    """Offsets added to a device's ticks and counts; 0 and 0 leave samples unchanged."""

    ticks: int = 0
    counts: int = 0

    def apply(self, s: Sample, period_s: float, per_count: float) -> Sample:
        """The sample in the ticks and counts of the record."""
        if not (self.ticks or self.counts):
            return s
        tick, counts = s.tick + self.ticks, s.counts + self.counts
        return s._replace(tick=tick, t_s=tick * period_s, counts=counts, position=counts * per_count)
