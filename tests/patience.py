"""How long a test waits for another process: what hangs is found out, and a busy machine is waited for."""

#: Seconds.
PATIENCE = 900
