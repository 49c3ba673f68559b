"""Fits of a measure to records with a measured input, with measurement effects and output terms."""
