"""The pictures of the documentation: drawn from the project's own code, kept as SVG beside this file.

``python -m figures`` in ``docs/`` draws them anew; a test draws them and compares. No picture is drawn by hand.
"""
