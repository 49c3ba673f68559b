"""One runner interprets protocols on any rig; every ending leaves the current at zero."""
