"""Published measurements beside the model: its values, their spread by constants, and the verdict on each row."""
