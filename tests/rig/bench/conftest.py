"""Fixtures of simulated chips for benches."""

from firmware import chips

build_folder, start = chips.build_folder, chips.start
