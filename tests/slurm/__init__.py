"""The pipeline on a real Slurm."""
