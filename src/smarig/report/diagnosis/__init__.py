"""Pages of a diagnosis: the verdict in words, tables and figures."""
