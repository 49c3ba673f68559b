"""The measurement effects, one file each."""
