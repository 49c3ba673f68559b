"""FOD surfaces and tables from settled points (thesis §5.4)."""
