"""Options that belong together: a command receives the values of all of them as one argument."""

from collections.abc import Callable, Sequence
from functools import wraps
from inspect import signature
from typing import Any


def option_group(
    argument: str, values: Callable[..., Any], options: Sequence[Callable[[Callable], Callable]]
) -> Callable[[Callable], Callable]:
    """A decorator that adds ``options`` to a command, listed in this order by ``--help``.

    ``values`` takes an argument for each option, by its name; what it returns is the command's ``argument``.
    """
    names = signature(values).parameters

    def add(command: Callable) -> Callable:
        @wraps(command)
        def gathered(*args: Any, **rest: Any) -> Any:
            taken = {name: rest.pop(name) for name in names}
            return command(*args, **{argument: values(**taken)}, **rest)

        for option in reversed(options):
            gathered = option(gathered)
        return gathered

    return add
