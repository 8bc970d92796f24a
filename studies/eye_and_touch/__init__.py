"""Study `eye_and_touch`: accuracy by eye, the gain by touch, and the gain per second of further touches."""
