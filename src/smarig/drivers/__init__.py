"""Drivers say to instruments what a bench wants: one file per instrument. They know registers, and no physics."""
