"""What could not be told to a device is told to the person, on every ending."""

import pytest

from smarig.errors import Interrupted, LimitExceeded, RigFault
from smarig.rig.opening import _told
from smarig.wire.blame import Silent

UNTOLD = "The amplifier could not be told."


class Deaf:
    """A rig that cannot be told to be off."""

    untold = ""

    def safe(self):
        self.untold = UNTOLD


@pytest.mark.parametrize(
    ("ending", "kind", "says"),
    [
        (
            Interrupted("interrupted by the keyboard (Ctrl-C)"),
            RigFault,
            f"Run interrupted by .* it is closed. {UNTOLD}",
        ),
        (LimitExceeded("Too hot. The current is at zero."), LimitExceeded, rf"^Too hot\. {UNTOLD}$"),
        (Silent("No answer."), Silent, rf"^No answer\. {UNTOLD}$"),
    ],
)
def test_an_ending_does_not_say_that_the_current_is_at_zero(ending, kind, says):
    with pytest.raises(kind, match=says), _told(Deaf()):
        raise ending


def test_nor_does_the_end_of_a_run():
    with pytest.raises(RigFault, match=f"{UNTOLD} What was recorded until then is whole."), _told(Deaf()):
        pass
