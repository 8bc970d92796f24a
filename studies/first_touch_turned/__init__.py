"""Study `first_touch_turned`: the first touch on objects that are turned about the vertical, or in any way."""
