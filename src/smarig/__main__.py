"""``python -m smarig``: the same as the command ``smarig``."""

from smarig.cli import main

main()
