"""Runs of one wire as one story on one clock, and that story as a model would have lived it.

``told`` turns runs into commands and readings and knows no model; ``retelling`` drives the plant, effects
included, along the commands and knows no data.
"""
