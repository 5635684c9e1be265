"""Heat from a warm contact: temperature of the layers in time, and the charge that it makes on the electrodes."""
