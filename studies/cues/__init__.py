"""What carries the accuracy: positions, normals, imprints, or all of them."""
