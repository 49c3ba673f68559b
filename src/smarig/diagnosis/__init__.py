"""What the simulation gets wrong, why, and by how much an extended model is better: the critic.

In the order of the work, after ``smarig.replay``: ``candidates`` (what might be wrong), ``refit`` (everything refitted
at once), ``nulls``, ``critique`` (is anything wrong?), ``refine`` and ``search`` (what is it?), ``verdict``, ``gain``;
``diagnose`` puts them together. ``given`` is for measured inputs, ``thermal`` for transients of temperature alone.
"""
