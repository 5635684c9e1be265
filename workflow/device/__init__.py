"""A sensor in time: its contact as a function of force, the circuit that reads it, and the signal of a history."""
