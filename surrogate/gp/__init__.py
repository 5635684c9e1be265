"""Gaussian processes on factorials: kernels, tensor trains and files, and the face of every surrogate."""
