"""The commands: one file each, found by its name. Each module defines ``command``."""
