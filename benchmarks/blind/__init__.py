"""Blind diagnosis of sealed boxes: ``trial`` diagnoses one and then opens it, ``table`` scores many.

The boxes come from ``benchmarks.boxes``, which shares no code with the diagnosis.
"""
