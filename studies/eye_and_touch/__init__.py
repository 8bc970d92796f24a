"""Study `eye_and_touch`: what the eye alone recognises, what touch adds, and what the next touch is worth."""
