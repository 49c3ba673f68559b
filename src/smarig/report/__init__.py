"""Pages of runs, models, diagnoses and closed loops as single HTML files that need no network."""
