"""Study `first_touch`: whether the eye helps to choose the first touch, and by what."""
