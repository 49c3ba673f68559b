"""Runs the command ``smarig`` as ``python -m smarig``."""

from smarig.cli import main

main()
