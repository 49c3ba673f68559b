"""The wire's own constants: heat loss, time constant, resistances."""
