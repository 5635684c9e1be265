"""Design questions: terms over scenarios, counted by a risk measure, as a program for an optimiser."""
