"""Which effects explain what is left."""
