"""A layered body in Fourier space: layers, multiplier, gradings and electrodes; lines and points use it."""
