"""Continue an interrupted run the way hysteresis allows."""
