"""Building blocks of all pages: escaped HTML, figures, formatted numbers, styles."""
