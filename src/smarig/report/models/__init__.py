"""Pages of identified models: a characterisation, and models compared."""
