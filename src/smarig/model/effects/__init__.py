"""The catalogue of physical mechanisms: one file each, found by its name, the identity at zero strength."""
