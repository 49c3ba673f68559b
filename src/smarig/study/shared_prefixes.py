"""What the names of all columns share, as "field." in a list of a ROS topic, says nothing of any of them."""

from collections.abc import Sequence

from smarig.study.quantity_words import quantity_of_name

_SEPARATORS = "./:|\\"  # of paths; a blank or an underscore is within a name
_FEWEST = 2


def shared_prefix(names: Sequence[str]) -> str:
    """The longest prefix, up to a separator, of all names or of all but one, which may be the clock's; "" if there is
    none, or if the names say nothing without it.

    >>> shared_prefix(["time", "field.header.seq", "field.current_ma", "field.temp_c"])
    'field.'
    >>> shared_prefix(["t", "dL.1", "dL.2"])
    ''
    """
    ends = {name[: k + 1] for name in names for k, sign in enumerate(name[:-1]) if sign in _SEPARATORS}
    for prefix in sorted(ends, key=len, reverse=True):
        rest = [name.removeprefix(prefix) for name in names if name.startswith(prefix)]
        if len(rest) >= max(_FEWEST, len(names) - 1) and any(quantity_of_name(name)[0] for name in rest):
            return prefix
    return ""
