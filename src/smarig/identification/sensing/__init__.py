"""Self-sensing: the map from position to resistance from recorded runs, and its errors on other runs."""
