"""Surfaces, rays that meet them, and how they bend."""
