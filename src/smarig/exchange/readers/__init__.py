"""Formats that can be imported: one file each, found by file name."""
