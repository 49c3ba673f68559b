"""The model refitted to the timeline: hysteresis, noise and nuisance terms by restricted likelihood."""
