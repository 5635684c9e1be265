"""Heat that a touch brings: temperature of the layers in time, and the charge that it makes on the electrodes."""
