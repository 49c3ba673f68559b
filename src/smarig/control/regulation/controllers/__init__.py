"""Controllers that hold a set-point, one file each, found by file name.

Signature: ``NAME(setup, hysteresis, count, *, …)`` gives a ``SetpointController``; ``count`` is the position of one
count. A number whose default is None is set by the model. An indented docstring line for each number,
``name (unit): meaning``, appears in listings; "unit" is that of the rig, mm or deg.
"""
