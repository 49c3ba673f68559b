"""Mapping files: what the columns of a data file mean."""
