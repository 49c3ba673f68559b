"""Redraws all figures, or the named ones: ``python -m figures [NAME …]`` in ``docs/``."""

import sys

from figures.gallery import FOLDER, PICTURES

for name in sys.argv[1:] or PICTURES:
    (FOLDER / f"{name}.svg").write_text(PICTURES[name]().svg(), encoding="utf-8")
