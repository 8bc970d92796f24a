"""Surfaces: meshes with textures, ray casting, normals and curvature."""
