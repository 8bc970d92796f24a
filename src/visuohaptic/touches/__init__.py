"""Phase `touches`: from probing locations to imprints.

Its parameters are those of `visuohaptic.sensor` and `visuohaptic.scene`.
"""
