"""The contract of instruments: requirements that every driver fulfils, each tested on the instrument itself."""
