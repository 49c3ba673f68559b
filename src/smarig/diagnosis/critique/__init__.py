"""The test whether residuals exceed noise, against null data."""
