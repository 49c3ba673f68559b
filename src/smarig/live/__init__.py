"""A run seen while it happens, or again: what the rig does, drawn for eyes.

Samples go into a bounded queue (``pump``), are made into marks (``drawer``: pure values, no viewer), and only
``screen`` turns marks into what a viewer understands. Refuses to know how models are identified and files exported.
"""
