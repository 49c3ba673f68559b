"""Formats a run can be exported to: one file each, found by file name."""
