"""What is beside the contact: air under a conducting punch (theory section 10)."""
