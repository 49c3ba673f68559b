"""Diagnosis of thermal records."""
