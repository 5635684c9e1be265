"""One thin script a rule."""
