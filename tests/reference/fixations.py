"""The fixations on a saliency map, from docs/attention.md, "Scanpath" and "The object's outline", in numbers.

All arrays are float64. Winner-take-all with inhibition of return after Itti, Koch & Niebur 1998.
"""

from dataclasses import dataclass

import numpy as np

TIE = 1e-4  # drives this close to the largest tie
ROUNDING = 1e-6  # drives this close differ by rounding only
INWARD = 1e-3  # drive added at the pixel farthest from the outline
MARGIN = 0.016  # least distance from the outline, of the view's longer edge
THIN = 0.7  # the same in thin parts, of the largest distance nearby
CLOSED = -1.0  # drive of a pixel that can't be fixated
SPARE = 16  # docs/extending.md: locations in place of those out of reach


@dataclass
class Fixation:
    """A fixated pixel, and how it won."""

    row: int
    column: int
    tied: int  # pixels within TIE of the largest drive
    rivals: list  # (row, column) of other pixels within ROUNDING of the winner


def distance_from_outline(mask):
    """Return each pixel's distance (pixels) from the nearest pixel off the object; the view's edge is off it too.

    Borgefors 1986: the shortest chain of steps of length 1 (to the side), 1.4 (slanted) and 2.1969 (a knight's move).
    The lengths are rounded to multiples of 2^-16. So a distance of 1.4 is a little less than 0.7 of a distance of 2.
    """
    steps = []
    for down in range(-2, 3):
        for across in range(-2, 3):
            length = {(0, 1): 1.0, (1, 1): 1.4, (1, 2): 2.1969}.get(
                tuple(sorted((abs(down), abs(across))))
            )
            if length:
                steps.append((down, across, round(length * 2**16) / 2**16))
    rows, columns = mask.shape
    distance = np.where(np.pad(mask, 1), np.inf, 0.0)
    while True:
        around = np.pad(distance, 2, constant_values=np.inf)
        nearer = distance
        for down, across, length in steps:
            shifted = around[2 + down : 4 + down + rows, 2 + across : 4 + across + columns]
            nearer = np.minimum(nearer, shifted + length)
        if np.array_equal(nearer, distance):
            return distance[1:-1, 1:-1]
        distance = nearer


def allowed_pixels(mask):
    """Return the pixels (h, w), bool, that may be fixated: inside the outline, in thin parts near their middle."""
    depth = distance_from_outline(mask)
    margin = MARGIN * max(mask.shape)
    reach = round(margin)
    allowed = np.zeros(mask.shape, bool)
    for row, column in np.argwhere(mask):
        largest = 0.0
        for down in range(-reach, reach + 1):
            width = round(np.sqrt(reach**2 - down**2))
            if 0 <= row + down < mask.shape[0]:
                left = max(column - width, 0)
                largest = max(largest, depth[row + down, left : column + width + 1].max())
        allowed[row, column] = depth[row, column] >= min(margin, THIN * largest)
    return allowed


def scan(
    saliency, mask, positions, count, radius=0.2, falloff=1.0
):  # positions: (h, w, 3) object radii, or (h, w, 2) pixels
    """Return at most `count` fixations in order.

    Parameters
    ----------
    saliency, mask : arrays (h, w)
        The saliency map, and the object's pixels.
    positions : array (h, w, d)
        Where each pixel is: its point on the surface, or its row and column.
    count : int
        Number of fixations.
    radius : float
        Radius of the focus, in the unit of the positions.
    falloff : float
        Width of the rim around the focus, in radii of the focus.
    """
    depth = distance_from_outline(mask)
    allowed = allowed_pixels(mask)
    inward = depth / max(depth[allowed].max(initial=0.0), 1.0)
    drive = np.where(allowed, saliency + INWARD * inward, CLOSED)
    found = []
    while len(found) < count and drive.max() > CLOSED:
        # The upper, then left neighbourhood of tied pixels wins; within it the largest drive.
        tied = [tuple(pixel) for pixel in np.argwhere(drive >= drive.max() - TIE)]
        first = positions[tied[0]]
        near = [p for p in tied if np.sqrt(((positions[p] - first) ** 2).sum()) <= radius]
        largest = max(drive[p] for p in near)
        best = [p for p in near if drive[p] >= largest - ROUNDING]
        winner = best[0]
        found.append(Fixation(*map(int, winner), len(tied), best[1:]))
        for row, column in np.argwhere(drive > CLOSED):
            away = np.sqrt(((positions[row, column] - positions[winner]) ** 2).sum()) / radius
            if away <= 1:
                drive[row, column] = CLOSED
            elif away < 1 + falloff:
                # Inhibition fades out smoothly (a cubic with level ends) over the rim.
                t = (away - 1) / falloff
                drive[row, column] *= t * t * (3 - 2 * t)
    return found
