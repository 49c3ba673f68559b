"""Numbers of the register definition by name: orders, states, faults and refusals."""

NONE, ARM, OFF, REARM = range(4)
IS_OFF, ARMED, TRIPPED = range(3)
LEASE, OVER_CURRENT, SLEW, HEAT, SHORT, RESISTANCE, OPEN, STOP = range(1, 9)
WIRE_TEMPERATURE, NO_TEMPERATURE = 9, -32768
NO_REGISTER, BAD_WORD, NOT_NOW = 2, 3, 4
STOP_IS_OPEN = 2  # of an amplifier's hardware word
