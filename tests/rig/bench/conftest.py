"""Chips for benches, too."""

from firmware import chips

build_folder, start = chips.build_folder, chips.start
