"""Models that wrap others: over groups of inputs, maxima of curves, corrections by measured rows."""
