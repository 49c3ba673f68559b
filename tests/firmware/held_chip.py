"""A chip whose ticks the test gives: no exchange depends on time, and each ended request is reported.

An emulator hands a frame over in pieces, and a busy machine may let a silence pass between two of them. That ends the
frame as on any line; the chip says so, and the frame is repeated.
"""

import queue

QUIET_S = 0.5  # after which nothing more of a frame in pieces comes


class HeldChip:
    """A chip that is held; it can be given the boot counts, ticks and requests of a script."""

    def __init__(self, chip):
        self._chip = chip
        self.pieces = 0  # frames that did not arrive whole
        chip.tell("hold")
        assert chip.said() == ("held",)

    def obeys(self, line):
        self._chip.tell(line)
        assert self._chip.said() == ("done",)

    def boot(self, boot_count):
        self.obeys(f"boot {boot_count}")

    def tick(self, *inputs):
        self.obeys(f"tick {' '.join(map(str, inputs))}")

    def now(self, raw_counts):
        self.obeys(f"now {raw_counts}")

    def answer(self, request):
        """The reply to a request."""
        while True:
            self._chip.send(request)
            word, count, replied = self._chip.said()
            assert word == "answered"
            if count == len(request):
                return self._chip.receive(replied) if replied else b""
            assert not replied, "a piece of a frame has a wrong check word"
            self.pieces += 1
            self._quiet()

    def _quiet(self):
        """Until the rest of a frame in pieces has gone."""
        try:
            while True:
                word, _, replied = self._chip.said(QUIET_S)
                assert (word, replied) == ("answered", 0)
        except queue.Empty:
            pass
