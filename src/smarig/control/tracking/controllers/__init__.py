"""Controllers of position, one file each, found by file name: generators that yield currents and are sent samples.

``NAME(known, wanted, *, …)``; ``RANGES`` in the same file gives, for every number that may be tuned, the least and the
largest. What a rig's limits forbid is clipped by the loop, and shows as ``current_command_A`` of the sample.
"""
