"""The web application of the console: pages on loopback, guarded by a token, that show and request; runs are elsewhere."""
