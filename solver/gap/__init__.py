"""Air beside the contact, under a conducting punch (theory section 10)."""
