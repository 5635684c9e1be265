"""The language of limits and goals: units, expressions, statements. Nothing is executed."""
