"""From a table to the columns and steps of a run."""
