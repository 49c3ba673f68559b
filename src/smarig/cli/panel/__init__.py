"""The run on the terminal: panel, log lines, keys."""
