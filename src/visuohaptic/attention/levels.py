"""The size of the working image, and the pyramid levels of centres and surrounds."""

WORKING_SIZE = 128
"""Rows and columns of the working image."""

# A pixel of level n covers about 2^n / 128 of the view. Levels 0 to 2 of 128 pixels are levels 2 to 4 of 512
# pixels, the centres of Itti, Koch & Niebur 1998.
CENTRE_LEVELS = (0, 1, 2)
"""Pyramid levels of the centres."""

# Itti, Koch & Niebur 1998 have 3 and 4. The coarsest surround would then have 2 x 2 pixels.
SURROUND_OFFSETS = (2, 3)
"""How many levels a surround is coarser than its centre."""
