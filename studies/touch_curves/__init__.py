"""Study `touch_curves`: accuracy over the number of touches, by every strategy, one of them adaptive."""
