"""The size of the working image, in pixels, and the levels of its pyramid that are compared."""

WORKING_SIZE = 128
# Pyramid levels of the centres, and by how many levels their surrounds are coarser. Level n averages over some
# 2^n / 128 of the view at every resolution. Levels 0 to 2 are 2 to 4 of an image of 512 pixels, as in Itti, Koch &
# Niebur 1998; their surrounds, 3 and 4 levels coarser, would go beyond level 5, which has 4 x 4 pixels.
CENTRE_LEVELS = (0, 1, 2)
SURROUND_OFFSETS = (2, 3)
