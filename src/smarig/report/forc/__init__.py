"""Figures and sentences of the page of first-order (reversal) curves."""
