"""The command ``meecontact``: options, tables, what is printed."""

import os

# before NumPy is loaded: sums that threads share differ in their last digits, and with them the last digits of designs;
# a job of the pipeline has one thread by Snakemake
os.environ.setdefault("OMP_NUM_THREADS", "1")
