"""The cells and lines of texts: numbers, clock times, marks without a reading, interruptions."""
