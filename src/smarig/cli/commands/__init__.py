"""One file per command, found by its name; each holds ``command``."""
