"""A finished run's touches as a data set that other tools read: tactile images with class labels."""
