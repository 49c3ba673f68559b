"""An unconfirmed shutdown is reported to the user on every ending."""

import pytest

from smarig.core.errors import Interrupted, LimitExceeded, RigFault
from smarig.device.encoding.link_faults import Silent
from smarig.rig.open_rig import _confirmed_shutdown

SHUTDOWN_UNCONFIRMED = "The amplifier could not be told."


class Deaf:
    """A rig that does not accept the command to switch off."""

    shutdown_unconfirmed = ""

    def safe(self):
        self.shutdown_unconfirmed = SHUTDOWN_UNCONFIRMED


@pytest.mark.parametrize(
    ("ending", "kind", "says"),
    [
        (
            Interrupted("interrupted by the keyboard (Ctrl-C)"),
            RigFault,
            f"Run interrupted by .* Its file is closed. {SHUTDOWN_UNCONFIRMED}",
        ),
        (
            LimitExceeded("Too hot. The current is at zero."),
            LimitExceeded,
            rf"^Too hot\. {SHUTDOWN_UNCONFIRMED}$",
        ),
        (Silent("No answer."), Silent, rf"^No answer\. {SHUTDOWN_UNCONFIRMED}$"),
    ],
)
def test_an_unconfirmed_shutdown_does_not_claim_zero_current(ending, kind, says):
    with pytest.raises(kind, match=says), _confirmed_shutdown(Deaf()):
        raise ending


def test_nor_does_the_end_of_a_run():
    with (
        pytest.raises(RigFault, match=f"{SHUTDOWN_UNCONFIRMED} The recorded data are complete."),
        _confirmed_shutdown(Deaf()),
    ):
        pass
