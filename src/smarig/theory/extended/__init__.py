"""Beyond the classical operator (thesis §3.5): one file per extension, each plain Preisach at zero strength."""
