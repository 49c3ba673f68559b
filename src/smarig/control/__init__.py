"""Control of a hysteretic wire (thesis ch. 8): passivity, velocity feedback, set-point regulation, tracking.

A closed loop is a protocol like any other: a generator of inert commands, so the rig's limits, trips and lease hold.
Knows models and protocols; refuses to know rigs, devices, records and identification.
"""
