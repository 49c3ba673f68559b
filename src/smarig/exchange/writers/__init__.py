"""The export formats: one file each, found by file name."""
