"""Who asked for the end of a run: stored in its end, and told wherever the run is shown."""

import os
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Self

from smarig.core import Requester, printable

_LONGEST = 100  # characters of the name of an account


@dataclass(frozen=True)
class StoppedBy:
    """The kind of the one who asked, and the account of the computer that the run belonged to.

    Only processes of the same account can ask a run to stop, so the account is that of the one who asked.
    """

    kind: Requester
    account: str

    @classmethod
    def this_account(cls, kind: Requester) -> Self:
        """A request to a run of this process."""
        return cls(kind, _account())

    @classmethod
    def of(cls, table: Any) -> Self | None:
        """As it is stored; None for what this version does not know."""
        if not isinstance(table, Mapping) or table.get("kind") not in list(Requester):
            return None
        account = table.get("account")
        return cls(Requester(table["kind"]), account if isinstance(account, str) else "")

    @property
    def text(self) -> str:
        """In words.

        >>> StoppedBy(Requester.CONSOLE, "ada").text
        'a console of ada'
        """
        return (
            f"{self.kind.words} of {printable(self.account, _LONGEST)}" if self.account else self.kind.words
        )


def _account() -> str:
    """The name of the account of this process, or its number."""
    if not hasattr(os, "getuid"):
        return os.environ.get("USERNAME", "")
    import pwd  # which Windows does not have

    try:
        return pwd.getpwuid(os.getuid()).pw_name
    except KeyError:  # an account without an entry, as in a container
        return str(os.getuid())
