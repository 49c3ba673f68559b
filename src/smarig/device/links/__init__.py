"""Links between host and device that carry requests and replies, one file per kind."""
