"""Pages of identified models: a characterisation, models compared, a certificate."""
