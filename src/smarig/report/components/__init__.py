"""What all pages are built from: escaped HTML, figures, numbers in words, styles."""
