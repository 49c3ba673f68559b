"""Pages of identified models: characterisation, model comparison and certificate."""
