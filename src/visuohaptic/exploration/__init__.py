"""Load, touch and recognise objects in Python, without the workflow."""
