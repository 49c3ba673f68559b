"""Velocity controllers, one file each: the file name is the name, the function of that name makes it."""
