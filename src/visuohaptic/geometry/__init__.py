"""Surfaces, the images on them, rays that meet them, and how they bend."""
