"""Study `eye_and_touch`: accuracy of the eye, what touch adds to it, and what the next touch is worth."""
