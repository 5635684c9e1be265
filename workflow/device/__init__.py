"""A sensor in time: what its contact gives by force, the circuit that reads it, and the signal of a history."""
