"""The density of scattered first-order reversal curves."""
