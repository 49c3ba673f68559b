"""The web application of the console: pages on loopback, guarded by a token; runs are elsewhere."""
