"""A clause as the beginning of a sentence."""


def capitalised(clause: str) -> str:
    """The clause with a capital; names with an underscore stay as they are.

    >>> capitalised("nothing stands out"), capitalised("input_drift fits")
    ('Nothing stands out', 'input_drift fits')
    """
    return clause if "_" in clause.split(" ")[0] else clause[:1].upper() + clause[1:]
