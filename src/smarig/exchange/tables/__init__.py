"""Tables in texts: headings, dialects, and what is not a row."""
