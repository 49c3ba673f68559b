"""Draws pictures anew: ``python -m figures`` in ``docs/``, all of them or those named."""

import sys

from figures.gallery import FOLDER, PICTURES

for name in sys.argv[1:] or PICTURES:
    (FOLDER / f"{name}.svg").write_text(PICTURES[name]().svg(), encoding="utf-8")
