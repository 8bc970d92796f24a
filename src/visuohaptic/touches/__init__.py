"""Phase `touches`: from probing locations to imprints.

The parameters are in `visuohaptic.sensor.parameters` and `visuohaptic.scene.parameters`.
"""
