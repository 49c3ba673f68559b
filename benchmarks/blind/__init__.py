"""Blind diagnosis of sealed boxes: ``trial`` diagnoses one box and then opens it, ``score_table`` scores
many.

The boxes come from ``benchmarks.boxes``, which shares no code with the diagnosis.
"""
