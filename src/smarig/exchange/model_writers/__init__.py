"""Formats that models are exported to, one file each."""
