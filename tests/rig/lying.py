"""A rig with false readings."""

from smarig.rig.twin import Twin


class TamperedRig:
    """A twin whose samples are changed before anybody sees them."""

    def __init__(self, rig, change):
        self.twin, self._change = Twin.named(rig), change

    def __getattr__(self, name):
        return getattr(self.twin, name)

    def step(self, current_A, at_most=1):
        return tuple(self._change(sample) for sample in self.twin.step(current_A, at_most))
