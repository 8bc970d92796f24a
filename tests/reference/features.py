"""The features of the default experiment, once more: plain loops, written from the documentation.

Sources: M. N. Do, M. Vetterli, "The contourlet transform: an efficient directional multiresolution image
representation", IEEE Transactions on Image Processing 14(12), 2005; S.-M. Phoong, C. W. Kim,
P. P. Vaidyanathan, R. Ansari, "A new class of two-channel biorthogonal filter banks and wavelet bases", IEEE
Transactions on Signal Processing 43(3), 1995, for the ladder and its half-band filter; A. Cohen,
I. Daubechies, J.-C. Feauveau, "Biorthogonal bases of compactly supported wavelets", 1992, for the 9-7 pair;
and packages/contourlets/docs/transform.md for the conventions. This module imports nothing of the package
that it checks. Resampling by a unimodular matrix R is y[n] = x[R n], with n = (row, column), and the array is
periodic along the axis that moves.
"""

import numpy as np

# 9-7 pair with the digits of the reference toolbox; both sum to √2.
H = [0.037828455506995, -0.023849465019380, -0.11062440441842, 0.37740285561265]
H = [*H, 0.85269867900940, *H[::-1]]
G = [-0.064538882628938, -0.040689417609558, 0.41809227322221]
G = [*G, 0.78848561640566, *G[::-1]]
# Half-band prototype `pkva` of 12 taps (Phoong et al. 1995), from its middle outwards.
HALF = [0.6300, -0.1930, 0.0972, -0.0526, 0.0272, -0.0144]
BETA = [*HALF[::-1], *HALF]

CONTACT = 0.98  # least value of a sensing point in contact (docs/sensor.md, Statistics of an image)
LEAST_DEVIATION = 1e-9  # an image that varies less has skewness 0


# Laplacian pyramid (Do and Vetterli 2005, section II.B) -------------------------------------------------


def filtered(image, taps):
    """Filter rows and columns with a symmetric filter of odd length; the image is periodic."""
    middle = len(taps) // 2
    for axis in (0, 1):
        total = np.zeros(image.shape)
        for position, tap in enumerate(taps):
            total = total + tap * np.roll(image, middle - position, axis=axis)
        image = total
    return image


def detail_image(image):
    """Compute d = x − g ∗ ↑↓(h ∗ x): what the coarse image of half the size can't predict."""
    coarse = filtered(image, H)[::2, ::2]
    raised = np.zeros(image.shape)
    raised[::2, ::2] = coarse
    return image - filtered(raised, G)


# Directional filter bank (Do and Vetterli 2005, section II.C) -------------------------------------------


def sheared(x, matrix, times=1):
    """Resample by R1 = [1 1; 0 1], R2 = [1 −1; 0 1], R3 = [1 0; 1 1] or R4 = [1 0; −1 1], `times` times over."""
    y = np.empty(x.shape)
    rows, columns = x.shape
    for i in range(rows):
        for j in range(columns):
            if matrix == 1:
                y[i, j] = x[(i + times * j) % rows, j]
            elif matrix == 2:
                y[i, j] = x[(i - times * j) % rows, j]
            elif matrix == 3:
                y[i, j] = x[i, (j + times * i) % columns]
            elif matrix == 4:
                y[i, j] = x[i, (j - times * i) % columns]
    return y


def first_quincunx(x):
    """Return both polyphase components of the lattice Q1 = R2 D1 R3, '1r' of the toolbox."""
    y = sheared(x, 2)
    return sheared(y[0::2, :], 3), sheared(np.roll(y[1::2, :], -1, axis=1), 3)


def second_quincunx(x):
    """Return both polyphase components of the lattice Q2 = R4 D2 R1, '2c' of the toolbox."""
    y = sheared(x, 4)
    return sheared(y[:, 0::2], 1), sheared(np.roll(y[:, 1::2], -1, axis=0), 1)


def parallelogram(x, kind):
    """Return both polyphase components of P1 = D1 R3, P2 = D1 R4, P3 = D2 R1 or P4 = D2 R2."""
    if kind == 1:
        return sheared(x[0::2, :], 3), sheared(np.roll(x[1::2, :], -1, axis=1), 3)
    if kind == 2:
        return sheared(x[0::2, :], 4), sheared(x[1::2, :], 4)
    if kind == 3:
        return sheared(x[:, 0::2], 1), sheared(np.roll(x[:, 1::2], -1, axis=0), 1)
    return sheared(x[:, 0::2], 2), sheared(x[:, 1::2], 2)


def extended(x, before, after, quincunx):
    """Extend an array periodically on all four sides.

    A quincunx component of an image moves by half its columns at each turn past its rows ('qper_col' of the
    toolbox), because the image is periodic and the lattice is not.
    """
    rows, columns = x.shape
    y = np.empty((rows + before + after, columns + before + after))
    for i in range(-before, rows + after):
        for j in range(-before, columns + after):
            column = j
            if quincunx:
                column = j + i // rows * (columns // 2)
            y[i + before, j + before] = x[i % rows, column % columns]
    return y


def ladder_step(x, taps, shift, quincunx):
    """Filter rows and columns with an even number of taps, whose origin is moved by `shift` samples."""
    before = (len(taps) - 1) // 2 + shift
    after = len(taps) // 2 - shift
    wide = extended(x, before, after, quincunx)
    for axis in (0, 1):
        length = wide.shape[axis] - len(taps) + 1
        total = 0.0
        for position, tap in enumerate(taps[::-1]):
            total = total + tap * np.take(wide, range(position, position + length), axis=axis)
        wide = total
    return wide


def two_channels(p0, p1, quincunx=False):
    """Return both channels of the ladder: y0 = (p0 − F p1)/√2 and y1 = −√2 p1 − F y0 (Phoong et al. 1995)."""
    taps = []
    for position, tap in enumerate(BETA):
        taps.append(-tap if position % 2 == 0 else tap)
    y0 = (p0 - ladder_step(p1, taps, 1, quincunx)) / np.sqrt(2)
    y1 = -np.sqrt(2) * p1 - ladder_step(y0, taps, 0, quincunx)
    return y0, y1


def directional_bands(detail, levels=4):
    """Split an image into 2^levels directional bands, levels of 2 or more, in the order of the toolbox."""
    first, second = two_channels(*first_quincunx(detail), quincunx=True)
    bands = []
    for channel in (first, second):
        y0, y1 = two_channels(*second_quincunx(channel))
        bands += [y1, y0]
    for level in range(3, levels + 1):
        split = []
        for k, band in enumerate(bands):
            kind = k % 2 + 1
            if k >= 2 ** (level - 2):
                kind = k % 2 + 3
            y0, y1 = two_channels(*parallelogram(band, kind))
            split += [y1, y0]
        bands = split
    half = len(bands) // 2
    if levels > 2:
        # Back-sampling: bands 1 to half are sheared along their rows, the others along their columns.
        for k in range(2 ** (levels - 2)):
            times = 2 * (k + 1) - (2 ** (levels - 2) + 1)
            for band in (2 * k, 2 * k + 1):
                bands[band] = sheared(bands[band], 3, times)
                bands[band + half] = sheared(bands[band + half], 1, times)
    return bands[:half] + bands[half:][::-1]


# The 22 features of a touch (the paper, sections 3.3 and 3.4) -------------------------------------------


def standard_deviation(values):
    """Compute the standard deviation with N − 1 in the denominator, as Matlab's `std`."""
    values = np.ravel(values)
    mean = values.sum() / len(values)
    return np.sqrt(((values - mean) ** 2).sum() / (len(values) - 1))


def contourlet_deviations(image):
    """Compute the standard deviation of each of the 16 directional bands of an imprint."""
    detail = detail_image(np.asarray(image, float))
    return np.array([standard_deviation(band) for band in directional_bands(detail)])


def touch_features(image, place, normal):
    """Return the 22 features of a touch: 16 deviations, the place, and the outward unit normal."""
    return np.concatenate([contourlet_deviations(image), place, normal])


# The 13 statistics of an imprint (docs/sensor.md, Statistics of an image) ------------------------------------------------------------------------


def imprint_statistics(image):
    """Return the columns `imprint_…` of table features in their order.

    The image is taken as a height over columns x and rows y, each from −1 at the first cell to 1 at the last, and a
    quadric a + b x + c y + d x² + e x y + f y² is fitted by least squares.
    """
    image = np.asarray(image, float)
    count = len(image)
    places = [2 * cell / (count - 1) - 1 for cell in range(count)]
    terms, values = [], []
    for i, y in enumerate(places):
        for j, x in enumerate(places):
            terms.append([1, x, y, x * x, x * y, y * y])
            values.append(image[i, j])
    terms, values = np.array(terms), np.array(values)
    quadric = np.linalg.lstsq(terms, values, rcond=None)[0]
    _, b, c, d, e, f = quadric
    residual = values - terms @ quadric

    mean = values.sum() / len(values)
    deviation = np.sqrt(((values - mean) ** 2).sum() / len(values))
    skewness = 0.0
    if deviation > LEAST_DEVIATION:
        skewness = ((values - mean) ** 3).sum() / len(values) / deviation**3
    return np.array([
        mean,
        deviation,
        skewness,
        (values <= 0).sum() / len(values),
        (values >= CONTACT).sum() / len(values),
        2 * d + 2 * f,
        np.sqrt((2 * d - 2 * f) ** 2 + 4 * e**2),
        2 * d - 2 * f,
        abs(b),
        abs(c),
        np.sqrt(((residual - residual.mean()) ** 2).sum() / len(values)),
        np.abs(image[:, 1:] - image[:, :-1]).sum() / (count * (count - 1)),
        np.abs(image[1:, :] - image[:-1, :]).sum() / (count * (count - 1)),
    ])  # fmt: skip
