"""Network addresses that lack their scheme: by their form, before anything is opened."""

import re

_HOST_AND_PORT = re.compile(r"[A-Za-z0-9.-]+:\d+")


def no_scheme_text(url: str) -> str:
    """What is wrong with a network address that names no scheme; "" for any other address.

    >>> no_scheme_text("127.0.0.1:7199")
    '"127.0.0.1:7199" is no serial port. A network address names its scheme: "tcp://127.0.0.1:7199".'
    >>> no_scheme_text("COM3")
    ''
    """
    if not _HOST_AND_PORT.fullmatch(url):
        return ""
    return f'"{url}" is no serial port. A network address names its scheme: "tcp://{url}".'
