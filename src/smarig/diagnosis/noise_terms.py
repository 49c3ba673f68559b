"""The names of the noise figures of a diagnosis, as texts and pages print them; the glossary defines each.

None of them is the noise floor, which only repeats of one state in one run determine (``identification.noise_floor``):

- ``POINT_NOISE`` is fitted to all training runs with the density, so it needs no repeats; it includes past values
  of ``WIRE_NOISE``, which repeats share if they come soon after one another.
- ``WIRE_NOISE`` is what settled readings scatter along the input: of the room, the current's readings and the heating
  model, which settled readings do not distinguish.
- ``PREDICTION_LIMIT`` adds what the training runs leave open of the density.
"""

POINT_NOISE = "noise of a settled point"
WIRE_NOISE = "noise of the wire's temperature"
PREDICTION_LIMIT = "prediction limit"
