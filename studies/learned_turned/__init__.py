"""Study `learned_turned`: a network of touches on objects that are turned about the vertical, or in any way."""
