"""Hides what Matplotlib logs where the home folder cannot be written: it then uses a temporary folder."""

import logging

_FOLDER_WORDS = ("mkdir -p failed", "is not a writable directory", "temporary cache directory")


def hide_folder_messages() -> None:
    """Hide these messages; to be called before Matplotlib is imported, because it logs them then."""
    logger = logging.getLogger("matplotlib")
    if _is_of_other_matter not in logger.filters:
        logger.addFilter(_is_of_other_matter)


def _is_of_other_matter(record: logging.LogRecord) -> bool:
    return not any(words in record.getMessage() for words in _FOLDER_WORDS)
