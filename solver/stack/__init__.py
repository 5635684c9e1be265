"""A layered body in Fourier space: layers, response, waves and electrodes."""
