"""Run time of each effect, and its influence on images and accuracy."""
