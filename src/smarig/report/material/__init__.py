"""Figures and tables of an identified material."""
