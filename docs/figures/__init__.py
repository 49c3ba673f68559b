"""The figures of the documentation, drawn by the project's code and stored as SVG files in this folder.

``python -m figures`` in ``docs/`` redraws them. A test compares the files with newly drawn figures.
"""
