"""The saliency map of one square view, from docs/attention.md and the papers that it cites; each step in numbers.

All arrays are float64. A linear step along the rows or columns of an image is a matrix, so that each step can be read
as the weights of its sum. `both(matrix, image)` takes the step along rows and columns.
"""

import numpy as np

WORKING_SIZE = 128  # rows of the working image, level 0
MAP_SIZE = 64  # rows of the maps, level 1
CENTRES = (0, 1, 2)
STEPS = (2, 3)  # a surround is two or three levels coarser than its centre
EMPTY = 1e-4  # a pixel with a smaller share on the object has no mean
NOISE = 1e-4  # smaller differences are rounding
FAINT_PEAK = 0.01  # a fainter map is divided by this instead of by its maximum
BLACK = 0.1  # a tenth of full brightness
CHANNELS = {  # (two-sided, needs) of the channels of weight 1
    "colour": (True, "hues"),
    "intensity": (True, "colours"),
    "orientation": (False, "colours"),
    "contrast": (False, "colours"),
    "curvature": (False, "curvature"),
}


# Steps along an axis ---------------------------------------------------------------------------------------------


def both(matrix, image):
    """Apply a step to rows and columns."""
    return matrix @ image @ matrix.T


def kernel_matrix(size, kernel, repeated=False):
    """Return the matrix of a convolution with an odd kernel; outside the image are zeros, or the border repeated."""
    matrix = np.zeros((size, size))
    reach = len(kernel) // 2
    for row in range(size):
        for offset in range(-reach, reach + 1):
            source = row + offset
            if repeated:
                source = min(max(source, 0), size - 1)
            if 0 <= source < size:
                matrix[row, source] += kernel[offset + reach]
    return matrix


def halving(size, repeated=False):
    """Return the matrix to the next coarser level: (1, 3, 3, 1) / 8, so that both grids have the same centre."""
    matrix = np.zeros((size // 2, size))
    for row in range(size // 2):
        for offset, weight in zip((-1, 0, 1, 2), (1, 3, 3, 1), strict=True):
            source = 2 * row + offset
            if repeated:
                source = min(max(source, 0), size - 1)
            if 0 <= source < size:
                matrix[row, source] += weight / 8
    return matrix


def linear(size, new_size):
    """Return the matrix of linear interpolation between pixel centres, with the border repeated."""
    matrix = np.zeros((new_size, size))
    for row in range(new_size):
        place = (row + 0.5) * size / new_size - 0.5
        left = int(np.floor(place))
        for source, weight in ((left, left + 1 - place), (left + 1, place - left)):
            matrix[row, min(max(source, 0), size - 1)] += weight
    return matrix


def cubic(size, new_size):
    """Return the matrix of cubic convolution (Keys 1981) with the slope -0.75, with the border repeated."""
    slope = -0.75
    matrix = np.zeros((new_size, size))
    for row in range(new_size):
        place = (row + 0.5) * size / new_size - 0.5
        left = int(np.floor(place))
        for source in range(left - 1, left + 3):
            t = abs(place - source)
            if t <= 1:
                weight = (slope + 2) * t**3 - (slope + 3) * t**2 + 1
            else:
                weight = slope * (t**3 - 5 * t**2 + 8 * t - 4)
            matrix[row, min(max(source, 0), size - 1)] += weight
    return matrix


def area(size, new_size):
    """Return the matrix of means over the part of the larger image that each new pixel covers."""
    matrix = np.zeros((new_size, size))
    for row in range(new_size):
        start, end = row * size / new_size, (row + 1) * size / new_size
        for source in range(size):
            matrix[row, source] = max(0.0, min(end, source + 1) - max(start, source))
    return matrix * new_size / size


def smoothing(size, repeated=False):
    """Return the matrix of the kernel (1, 2, 1) / 4."""
    return kernel_matrix(size, np.array([1, 2, 1]) / 4, repeated)


def pyramid(image, coarsest, repeated=False):
    """Return levels 0 to `coarsest`, each half the size of the one before."""
    levels = [image]
    for _ in range(coarsest):
        levels.append(both(halving(len(levels[-1]), repeated), levels[-1]))
    return levels


def divide(image, certainty):
    """Return a smoothed image over the smoothed certainty (Knutsson & Westin 1993), 0 at empty pixels."""
    return np.where(certainty > EMPTY, image / np.maximum(certainty, EMPTY), 0.0)


# From a view to feature planes -----------------------------------------------------------------------------------


def prepare(colour, mask, curvature):
    """Return the working image of a square view as a dict of planes (128, 128)."""
    size = len(mask)
    step = area(size, WORKING_SIZE) if size > WORKING_SIZE else linear(size, WORKING_SIZE)
    step = smoothing(WORKING_SIZE) @ step
    cover = mask.astype(float)
    certainty = both(step, cover)
    brightest = colour[mask].max(initial=0.0)
    shade = colour * cover[..., None] / (brightest if brightest > 0 else 1.0)
    red, green, blue = (divide(both(step, shade[..., k]), certainty) for k in range(3))
    intensity = (red + green + blue) / 3
    return {
        "certainty": certainty,
        "red": red,
        "green": green,
        "blue": blue,
        "intensity": intensity,
        "backdrop": extend(intensity, certainty),
        "curvature": np.log(1 + divide(both(step, curvature * cover), certainty)),
    }


def extend(image, certainty):
    """Fill the background with means of the nearest parts: pull and push (Gortler et al. 1996)."""
    images, shares = [image * certainty], [certainty]
    while len(shares[-1]) > 4:
        images.append(both(halving(len(images[-1])), images[-1]))
        shares.append(both(halving(len(shares[-1])), shares[-1]))
    mass = shares[-1].sum()
    filled = np.full((2, 2), images[-1].sum() / mass if mass > 0 else 0.0)
    for level, share in zip(images[::-1], shares[::-1], strict=True):
        filled = level + (1 - share) * both(linear(len(filled), len(level)), filled)
    return filled


def colour_planes(view):
    """Return red-green and blue-yellow opponency (Walther & Koch 2006), both signs."""
    red, green, blue = view["red"], view["green"], view["blue"]
    largest = np.maximum(np.maximum(np.maximum(red, green), blue), BLACK)
    return [(red - green) / largest, (blue - np.minimum(red, green)) / largest]


def contrast_plane(view):
    """Return the local root mean square contrast in a Gaussian window of deviation 3, cut off at four deviations."""
    offsets = np.arange(-12, 13)
    kernel = np.exp(-(offsets**2) / (2 * 3.0**2))
    window = kernel_matrix(WORKING_SIZE, kernel / kernel.sum())
    certainty, intensity = view["certainty"], view["intensity"]
    mass = both(window, certainty)
    mean = divide(both(window, certainty * intensity), mass)
    variance = divide(both(window, certainty * (intensity - mean) ** 2), mass)
    return np.sqrt(variance) / (mean + BLACK)


def gabor_pair(degrees):
    """Return an even and an odd Gabor filter (9, 9), period 7, deviation 7/3, zero mean, unit norm."""
    x, y = np.meshgrid(np.arange(-4, 5), np.arange(-4, 5))
    along = x * np.cos(np.radians(degrees)) + y * np.sin(np.radians(degrees))
    envelope = np.exp(-(x**2 + y**2) / (2 * (7 / 3) ** 2))
    pair = []
    for wave in (np.cos, np.sin):
        kernel = envelope * wave(2 * np.pi * along / 7)
        kernel = kernel - kernel.mean()
        pair.append(kernel / np.sqrt((kernel**2).sum()))
    return pair


def correlate(image, kernel):
    """Return the sum of each pixel's neighbours times the kernel, with the border repeated."""
    reach = len(kernel) // 2
    size = len(image)
    padded = np.pad(image, reach, mode="edge")
    total = np.zeros_like(image)
    for row in range(len(kernel)):
        for column in range(len(kernel)):
            total += kernel[row, column] * padded[row : row + size, column : column + size]
    return total


def orientation_planes(image):
    """Return the root energy of Gabor pairs at 0, 45, 90 and 135 degrees, above their mean (Heeger 1992)."""
    energies = []
    for degrees in (0, 45, 90, 135):
        even, odd = (correlate(image, kernel) for kernel in gabor_pair(degrees))
        energies.append(both(smoothing(len(image), True), np.sqrt(even**2 + odd**2)))
    mean = sum(energies) / 4
    return [np.maximum(energy - mean, 0) for energy in energies]


def feature_planes(name, view):
    """Return per centre level a list of the channel's planes, each multiplied by the certainty of that level."""
    if name == "orientation":
        images = pyramid(view["backdrop"], max(CENTRES), repeated=True)
        certainties = pyramid(view["certainty"], max(CENTRES))
        return [
            [plane * certainties[level] for plane in orientation_planes(images[level])]
            for level in CENTRES
        ]
    planes = {
        "colour": lambda: colour_planes(view),
        "intensity": lambda: [view["intensity"]],
        "contrast": lambda: [contrast_plane(view)],
        "curvature": lambda: [view["curvature"]],
    }[name]()
    pyramids = [pyramid(plane * view["certainty"], max(CENTRES)) for plane in planes]
    return [[levels[level] for levels in pyramids] for level in CENTRES]


# From feature planes to the saliency map -------------------------------------------------------------------------


def centre_surround(plane, certainties, level, step):
    """Return centre minus surround at map size, signed and times the shares of both on the object."""
    size = len(plane)
    coarse = pyramid(plane, step)[step]
    enlarging = linear(len(coarse), size)
    share_of_centre = certainties[level]
    share_of_surround = both(enlarging, certainties[level + step])
    centre = divide(plane, share_of_centre)
    surround = divide(both(enlarging, coarse), share_of_surround)
    difference = (centre - surround) * share_of_centre * share_of_surround
    to_map = halving(size) if size > MAP_SIZE else linear(size, MAP_SIZE)
    return both(to_map, difference)


def scale(image):
    """Divide by the maximum, or by FAINT_PEAK where the maximum is smaller."""
    return image / max(image.max(), FAINT_PEAK)


def factor_of_local_maxima(image):
    """Return the factor of the operator N: (M - m)^2, at least 0.001.

    M is the maximum and m the mean of the other local maxima (Itti, Koch & Niebur 1998). Each pixel votes: it is a
    maximum by 1 minus its distance below the highest of its 3 x 3 neighbours, in thousandths; neighbours that are
    equally high divide one vote; a maximum counts by its height, from 0 at 0.05 to 1 at 0.15.
    """
    size = len(image)
    padded = np.pad(image, 1, constant_values=-np.inf)
    highest = image
    for down in range(3):
        for across in range(3):
            highest = np.maximum(highest, padded[down : down + size, across : across + size])
    peak = np.pad(np.maximum(0, 1 - (highest - image) / 0.001), 1)
    count = total = 0.0
    for row, column in np.argwhere(image > 0.05):
        crowd = max(peak[row : row + 3, column : column + 3].sum(), 1.0)
        height = image[row, column]
        vote = peak[row + 1, column + 1] / crowd * min((height - 0.05) / 0.1, 1.0)
        count += vote
        total += vote * height
    largest = image.max()
    mean_of_others = max(total - largest, 0.0) / max(count - 1, 1.0)
    return max((largest - mean_of_others) ** 2, 0.001)


def promote(image):
    """Apply the operator N."""
    return image * factor_of_local_maxima(image)


def conspicuity(name, view):
    """Return the conspicuity map (64, 64) of a channel."""
    two_sided, _ = CHANNELS[name]
    certainties = pyramid(view["certainty"], max(CENTRES) + max(STEPS))
    total, strongest = np.zeros((MAP_SIZE, MAP_SIZE)), 0.0
    for level, planes in zip(CENTRES, feature_planes(name, view), strict=True):
        for plane in planes:
            for step in STEPS:
                difference = centre_surround(plane, certainties, level, step)
                for side in (1, -1) if two_sided else (1,):
                    one = promote(scale(np.maximum(side * difference - NOISE, 0)))
                    total += one
                    strongest = max(strongest, one.max())
    return promote(scale(total)) * strongest


def running_channels(colour, mask, curvature):
    """Return the channels of weight 1 that a view can have."""
    seen = colour[mask]
    if len(seen) == 0:
        return []
    has = {
        "hues": (seen != seen[:, :1]).any() and (seen != seen[0]).any(),
        "colours": (seen != seen[0]).any(),
        "curvature": len(set(curvature[mask])) > 1,
    }
    return [name for name, (_, needs) in CHANNELS.items() if has[needs]]


def to_view(image, mask, interpolation):
    """Return a map at the pixels of a square view: at least 0, and 0 on the background."""
    return np.maximum(both(interpolation(len(image), len(mask)), image), 0) * mask


def saliency(maps, mask, weights=None):
    """Return the saliency map of a view from conspicuity maps (64, 64), divided by its maximum.

    `weights` has the weight of each channel, by default 1.
    """
    total = np.zeros((MAP_SIZE, MAP_SIZE))
    for channel, one in maps.items():
        total += one * (weights[channel] if weights else 1)
    seen = to_view(total, mask, cubic)
    return seen / seen.max() if seen.max() > 0 else seen
