"""Models whose answers follow from those of others: over groups of inputs, of curves, corrected by measured rows."""
