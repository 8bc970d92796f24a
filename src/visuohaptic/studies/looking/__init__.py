"""What the eye alone recognises, what touch adds to it, and when the next touch is worth its time."""
