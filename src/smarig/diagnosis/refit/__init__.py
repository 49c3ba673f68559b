"""The model refitted to the timeline: hysteresis and noise by restricted likelihood, and fits of effects."""
