"""Hystereses for the Preisach operator: surfaces, tables and relay measures, one file each."""
