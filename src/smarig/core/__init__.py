"""Foundations that every package may use: samples, commands, errors, files, catalogues."""
