"""What a surrogate is good for and how good it is: validation, sensitivity, inversion."""
