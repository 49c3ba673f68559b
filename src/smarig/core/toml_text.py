"""Parses the text of a TOML file, whatever it holds: what it is not is one phrase, known in a bounded time."""

import re
import tomllib
from typing import Any

_MOST_PARTS = 200  # of a dotted key: the time to read one grows with the square of its parts
_NAME = r"""(?:[\w-]++|"[^"\n]*+"|'[^'\n]*+')"""
_LONG_KEY = re.compile(rf"(?<![\w.-])(?:{_NAME}[ \t]*+\.[ \t]*+){{{_MOST_PARTS}}}")


class NotToml(ValueError):
    """A text is no TOML that can be read. Its message continues a sentence that begins with the name of the file."""


def parsed_toml(text: str) -> dict[str, Any]:
    """The values of a TOML text. Raises NotToml.

    >>> parsed_toml("a.b = 1")
    {'a': {'b': 1}}
    """
    if _LONG_KEY.search(text):
        raise NotToml(f"has a key of more than {_MOST_PARTS} parts")
    try:
        return tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        raise NotToml(f"is not valid TOML: {error}") from None
    except RecursionError:
        raise NotToml("is nested too deeply: its lists and tables contain each other") from None
    except ValueError:
        raise NotToml("contains an integer of too many digits") from None
