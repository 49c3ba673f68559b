"""What the simulation gets wrong, why, and by how much an extended model is better: the critic.

In the order of the work: ``story`` (what was done and measured), ``retelling`` (what the model would have
shown, with and without an effect), ``refit`` (everything refitted at once, whatever is linear in closed form),
``candidates``, ``nulls``, ``verdict``, ``gain``, ``proposal``.
"""
