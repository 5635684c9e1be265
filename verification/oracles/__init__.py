"""Independent evaluations of the contact problem; they share no code with the rooms that they judge."""
