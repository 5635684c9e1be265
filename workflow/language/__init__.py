"""What limits and goals are written in: units, expressions, statements. Nothing is executed."""
