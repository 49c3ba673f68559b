"""Self-sensing: the position of a wire from its voltage and current, in place of an encoder."""
