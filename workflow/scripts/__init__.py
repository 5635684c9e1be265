"""One thin script a rule: what a job reads and writes."""
