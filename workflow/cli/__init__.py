"""The command ``meecontact``: options, tables and printed answers."""

import os

# before NumPy is loaded: sums that threads share differ in their last digits, and with them the last digits of designs;
# whatever the user's environment says, as a job of the pipeline has one thread by Snakemake
for _library in ("OMP", "OPENBLAS", "MKL", "BLIS", "VECLIB_MAXIMUM"):
    os.environ[f"{_library}_NUM_THREADS"] = "1"
