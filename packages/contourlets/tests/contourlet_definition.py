"""A second, slow implementation of the contourlet transform, straight from its definition.

`toolbox_bands` works on one image with the toolbox's recursion: resample, take polyphase components,
extend, filter in two dimensions. `frequency_bands` never resamples: it multiplies the image's
spectrum by each band's frequency response and then samples the result at the band's pixels.
"""

import numpy as np
from scipy.signal import convolve2d

HALVES = {
    "pkva6": [0.6261, -0.1794, 0.0688],
    "pkva8": [0.6302, -0.1924, 0.0930, -0.0403],
    "pkva": [0.6300, -0.1930, 0.0972, -0.0526, 0.0272, -0.0144],
}
NINE = [0.037828455506995, -0.023849465019380, -0.11062440441842, 0.37740285561265]
NINE = np.array([*NINE, 0.85269867900940, *NINE[::-1]])
SEVEN = [-0.064538882628938, -0.040689417609558, 0.41809227322221]
SEVEN = np.array([*SEVEN, 0.78848561640566, *SEVEN[::-1]])
FIVE = np.array([-1, 2, 6, 2, -1]) / (4 * np.sqrt(2))
THREE = np.array([1, 2, 1]) / (2 * np.sqrt(2))
HAAR = np.array([1, 1]) / np.sqrt(2)
PYRAMIDS = {"9-7": (NINE, SEVEN), "5-3": (FIVE, THREE), "haar": (HAAR, HAAR)}


def modulated_ladder(name):
    beta = np.array([*HALVES[name][::-1], *HALVES[name]])
    return beta * (-1.0) ** np.arange(1, len(beta) + 1)


def around(x, up, down, left, right, half_turn=False):
    """Extend periodically; with `half_turn`, a wrap of rows shifts columns by half."""
    rows, columns = x.shape
    turned = np.roll(x, columns // 2, axis=1) if half_turn else x
    above, below = -(-up // rows), -(-down // rows)
    tall = np.vstack([turned if k % 2 else x for k in range(-above, below + 1)])
    tall = tall[above * rows - up : (above + 1) * rows + down]
    return np.pad(tall, ((0, 0), (left, right)), mode="wrap")


def filter_periodic(x, taps, delay=0, half_turn=False):
    """Filter separably; the origin of n taps is tap ⌊n/2⌋, and a delay of 1 is one sample."""
    before = (len(taps) - 1) // 2 + delay
    after = len(taps) - 1 - before
    wide = around(x, before, after, before, after, half_turn)
    return convolve2d(convolve2d(wide, taps[:, None], "valid"), taps[None, :], "valid")


def resample(x, matrix):
    """y[n] = x[R n], with each column (or each row) wrapping by itself."""
    i, j = np.indices(x.shape)
    return x[(i + matrix[0][1] * j) % x.shape[0], (j + matrix[1][0] * i) % x.shape[1]]


def shear(kind, amount=1):
    """The shears R1 … R4, or a power of one of them."""
    entry = amount if kind in (1, 3) else -amount
    return [[1, entry], [0, 1]] if kind in (1, 2) else [[1, 0], [entry, 1]]


def next_column(x):
    return np.hstack([x[:, 1:], x[:, :1]])


def next_row(x):
    return np.vstack([x[1:], x[:1]])


def polyphase(x, kind):
    if kind == "1r":
        y = resample(x, shear(2))
        return resample(y[::2], shear(3)), resample(next_column(y[1::2]), shear(3))
    if kind == "2c":
        y = resample(x, shear(4))
        return resample(y[:, ::2], shear(1)), resample(next_row(y[:, 1::2]), shear(1))
    if kind == 1:
        return resample(x[::2], shear(3)), resample(next_column(x[1::2]), shear(3))
    if kind == 2:
        return resample(x[::2], shear(4)), resample(x[1::2], shear(4))
    if kind == 3:
        return resample(x[:, ::2], shear(1)), resample(next_row(x[:, 1::2]), shear(1))
    return resample(x[:, ::2], shear(2)), resample(x[:, 1::2], shear(2))


def ladder(x, kind, name, half_turn=False):
    taps = modulated_ladder(name)
    p0, p1 = polyphase(x, kind)
    y0 = (p0 - filter_periodic(p1, taps, 1, half_turn)) / np.sqrt(2)
    return y0, -np.sqrt(2) * p1 - filter_periodic(y0, taps, 0, half_turn)


def quincunx_down(x, kind):
    first, last, axis = {"1r": (2, 3, 0), "1c": (3, 2, 1), "2r": (1, 4, 0), "2c": (4, 1, 1)}[kind]
    y = resample(x, shear(first))
    return resample(y[::2] if axis == 0 else y[:, ::2], shear(last))


def haar_pair(x, kind, level):
    """Two-tap filters along the rows (along the columns for types 3 and 4), then quincunx sampling."""
    if level > 2:
        x = resample(x, shear(kind))
    neighbour = next_row(x) if kind in (3, 4) else next_column(x)
    quincunx = kind if level <= 2 else {1: "1r", 2: "2r", 3: "2c", 4: "1c"}[kind]
    total = quincunx_down((x + neighbour) / np.sqrt(2), quincunx)
    difference = quincunx_down((x - neighbour) / np.sqrt(2), quincunx)
    return (total, difference) if kind in (1, 3) else (difference, total)


def toolbox_directions(x, depth, name):
    if depth == 0:
        return [x]
    bands = [x]
    for level in range(1, depth + 1):
        children = []
        for number, band in enumerate(bands):
            half = len(bands) // 2
            if level <= 2:
                kind = ("1r", "2c")[level - 1]
            else:
                kind = number % 2 + (1 if number < half else 3)
            if name == "haar":
                children += haar_pair(band, kind, level)
            else:
                y0, y1 = ladder(band, kind, name, half_turn=level == 1)
                children += [y0, y1] if level == 1 else [y1, y0]
        bands = children
    return back_sampled(bands, depth)


def back_sampled(bands, depth):
    half = len(bands) // 2
    if depth == 1:
        bands = [resample(band, shear(4)) for band in bands]
        for band in bands:
            for parity in (0, 1):
                band[:, parity::2] = resample(band[:, parity::2], shear(1))
    if depth > 2:
        for pair in range(half // 2):
            amount = 2 * (pair + 1) - (half // 2 + 1)
            for k in (2 * pair, 2 * pair + 1):
                bands[k] = resample(bands[k], shear(3, amount))
                bands[half + k] = resample(bands[half + k], shear(1, amount))
    return bands[:half] + bands[half:][::-1]


def toolbox_pyramid(x, name):
    analysis, synthesis = PYRAMIDS[name]
    coarse = filter_periodic(x, analysis)[::2, ::2]
    up = np.zeros_like(x)
    up[::2, ::2] = coarse
    return coarse, x - filter_periodic(up, synthesis, (len(synthesis) + 1) % 2)


def toolbox_bands(x, levels, pyramid="9-7", directional="pkva"):
    """The coarse image, then the bands of every level, the coarsest level first, in one list."""
    if not levels:
        return [x]
    coarse, detail = toolbox_pyramid(x, pyramid)
    fine = toolbox_directions(detail, levels[-1], directional)
    return [*toolbox_bands(coarse, levels[:-1], pyramid, directional), *fine]


# Frequency responses ------------------------------------------------------------------------------

Q1, Q2 = np.array([[1, -1], [1, 1]]), np.array([[1, 1], [-1, 1]])
P1, P2 = np.array([[2, 0], [1, 1]]), np.array([[2, 0], [-1, 1]])
P3, P4 = np.array([[1, 1], [0, 2]]), np.array([[1, -1], [0, 2]])


def ladder_response(omega, matrix, neighbour, name):
    """Response of p0 ← F[p1; shift (1, 1)], with p1 one `neighbour` from p0 and both on `matrix`."""
    taps = modulated_ladder(name)
    offsets = len(taps) // 2 - 1 - np.arange(len(taps))
    along = [
        sum(
            t * np.exp(1j * o * np.tensordot(matrix[:, k], omega, 1))
            for t, o in zip(taps, offsets, strict=True)
        )
        for k in (0, 1)
    ]
    return np.exp(1j * np.tensordot(neighbour, omega, 1)) * along[0] * along[1]


def directional_responses(omega, depth, name):
    """Frequency response of every band at frequencies `(2, ...)`, and the pixel of its first sample."""
    nodes = [(np.ones(omega.shape[1:], complex), np.eye(2, dtype=int), np.zeros(2, int))]
    for level in range(1, depth + 1):
        children = []
        for number, (response, matrix, anchor) in enumerate(nodes):
            if level == 1:
                step, beside = Q1, [0, 1]
            elif level == 2:
                step, beside = Q2, [1, 0]
            else:
                kind = number % 2 + (0 if number < len(nodes) // 2 else 2)
                step = (P1, P2, P3, P4)[kind]
                beside = ([1, 1], [1, 0], [1, 1], [0, 1])[kind]
            neighbour = matrix @ beside
            child = matrix @ step
            F = ladder_response(omega, child, neighbour, name)
            h0 = np.sqrt(2) * (1 - F) / 2
            h1 = -np.sqrt(2) * (1 + np.conj(F) * (1 - F) / 2)
            first = (response * h0, child, anchor)
            second = (response * h1, child, anchor + neighbour)
            children += [first, second] if level == 1 else [second, first]
        nodes = children
    half = (len(nodes) + 1) // 2
    nodes = nodes[:half] + nodes[half:][::-1]
    return [(response, anchor) for response, _, anchor in nodes]


def frequency_directions(x, depth, name):
    """Bands on the true torus: one frequency response each, then sampling."""
    axes = [2 * np.pi * np.fft.fftfreq(n) for n in x.shape]
    omega = np.stack(np.meshgrid(*axes, indexing="ij"))
    spectrum = np.fft.fft2(x)
    bands = []
    for number, (response, anchor) in enumerate(directional_responses(omega, depth, name)):
        filtered = np.fft.ifft2(spectrum * response)
        assert np.abs(filtered.imag).max() < 1e-10
        bands.append(sample(filtered.real, depth, number, anchor))
    return bands


def sample(x, depth, number, anchor):
    rows, columns = x.shape
    if depth == 0:
        return x
    if depth == 1:
        i, j = np.indices((rows // 2, columns))
        return x[(2 * i - j % 2 + anchor[0]) % rows, (j + anchor[1]) % columns]
    coarse = 2 ** (depth - 1)
    steps = (coarse, 2) if number < 2 ** (depth - 1) else (2, coarse)
    i, j = np.indices((rows // steps[0], columns // steps[1]))
    return x[(anchor[0] + steps[0] * i) % rows, (anchor[1] + steps[1] * j) % columns]


def gratings(side, angles, frequency):
    i, j = np.indices((side, side))
    return np.stack(
        [np.cos(2 * np.pi * frequency * (i * np.sin(a) + j * np.cos(a))) for a in angles]
    )


def facing_band(angle, directions_log2):
    """Position of a frequency in the tiling, in widths of a band; its floor is the band's number.

    From the toolbox's index convention: uniform in the tangent over the first half of the bands,
    uniform in the cotangent, falling, over the second.
    """
    half = 2 ** (directions_log2 - 1)
    vertical, horizontal = np.sin(angle), np.cos(angle)
    if abs(vertical) < abs(horizontal):
        return (vertical / horizontal + 1) / 2 * half
    return half + (1 - horizontal / vertical) / 2 * half


def check_grating_sweep(transform, side, least_best_share):
    """Sweep 64 angles; compare the strongest band with the frequency responses and the ideal tiling."""
    (depth,) = transform.levels
    angles, frequency = np.pi * np.arange(64) / 64, 0.4
    bands = transform.forward(gratings(side, angles, frequency)).levels[0]
    energies = np.stack([np.square(band).sum(axis=(1, 2)) for band in bands], axis=1)
    shares = energies / energies.sum(axis=1, keepdims=True)
    winners = shares.argmax(axis=1)

    omega = 2 * np.pi * frequency * np.stack([np.sin(angles), np.cos(angles)])
    responses = directional_responses(omega, depth, transform.directional_filter)
    powers = np.square(np.abs(np.stack([response for response, _ in responses], axis=1)))
    first, second = np.sort(powers, axis=1)[:, :-3:-1].T
    decided = second < 0.6 * first
    assert decided.sum() > 40
    np.testing.assert_array_equal(winners[decided], powers.argmax(axis=1)[decided])

    # A ladder's second channel has twice the first one's gain where their passbands meet, so that
    # borders of the ideal tiling are moved by up to 0.4 of the width of one of 16 bands.
    places = np.array([facing_band(angle, depth) for angle in angles])
    away = np.abs(winners + 0.5 - places)
    away = np.minimum(away, len(bands) - away)
    assert away.max() < 0.9
    assert np.mean(away <= 0.5) > 0.85

    for k in range(len(bands)):
        assert shares[winners == k, k].max(initial=0) > least_best_share, k


def special_images(shape, rng):
    rows, columns = np.indices(shape)
    impulse = np.zeros(shape)
    impulse[shape[0] // 3, shape[1] // 2] = 1
    return {
        "noise": rng.standard_normal(shape),
        "zero": np.zeros(shape),
        "constant": np.full(shape, 3.7),
        "impulse": impulse,
        "corner": np.eye(*shape) * (rows + columns == 0),
        "checkerboard": (-1.0) ** (rows + columns),
        "ramp": 0.1 * rows - 0.3 * columns,
    }
