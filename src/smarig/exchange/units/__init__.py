"""Units of data files: how they are written, and their conversion."""
