"""Velocity controllers, one file each: the file name is the name, the function of that name makes it.

Defaults are in kelvin and the rig's output unit: gentle on both of the thesis's rigs, examples and no recommendation.
Numbers are told by indented lines of the docstring, ``name (unit): meaning``; "unit" is the rig's, mm or deg.
"""
