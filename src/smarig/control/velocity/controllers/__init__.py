"""Velocity controllers, one file each: a file's function of the same name makes the controller.

Defaults are in kelvin and the rig's output unit. They are gentle on both rigs of the thesis, so that ``certify`` has a
result to show; they are examples, not recommendations. Indented docstring lines ``name (unit): meaning`` describe the
numbers; "unit" is that of the rig, mm or deg.
"""
