"""Point contacts of revolution: spheres, cones, discs, power laws on half-spaces and films; NumPy arrays in and out."""
