"""Is anything left beyond noise: residuals against null data."""
