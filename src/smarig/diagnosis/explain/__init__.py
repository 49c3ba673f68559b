"""The search for effects that explain the residuals."""
