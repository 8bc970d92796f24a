"""Right answers in exact rationals. Nothing here imports the library."""

from fractions import Fraction

import numpy as np


def exact(values):
    """Return numbers as an array of Fractions."""
    values = np.asarray(values)
    whole = np.array([Fraction(value) for value in values.ravel().tolist()], dtype=object)
    return whole.reshape(values.shape)


def near(triangles, origin, direction):
    """Return the triangles that a line passes within a thousandth of, by float64."""
    corners = triangles - origin
    sides = np.einsum("fkd,d->fk", np.cross(corners, np.roll(corners, -1, axis=1)), direction)
    edges = np.linalg.norm(triangles - np.roll(triangles, -1, axis=1), axis=2)
    slack = 1e-3 * edges.max(axis=1, keepdims=True) * np.linalg.norm(direction)
    return triangles[(sides >= -slack).all(axis=1) | (sides <= slack).all(axis=1)]


def exact_first_hits(triangles, origins, directions):
    """Return the distance of each ray's first hit, rims included, decided in rationals; infinite for a miss."""
    rays = zip(origins, directions, strict=True)
    return np.array([float(exact_first_hit(triangles, *ray)) for ray in rays])


def exact_first_hit(triangles, origin, direction):
    d, best = exact(direction), np.inf
    for corner, first, second in exact(near(triangles, origin, direction)):
        a, b, s = first - corner, second - corner, exact(origin) - corner
        normal, q = np.cross(a, b), np.cross(s, d)
        determinant = -(d @ normal)
        if determinant == 0:
            continue
        t, u, v = (part / determinant for part in (s @ normal, q @ b, -(q @ a)))
        if t >= 0 and u >= 0 and v >= 0 and u + v <= 1:
            best = min(best, t)
    return best


def exact_moments(values):
    """Return mean, variance (population) and third moment about the mean, as Fractions."""
    values = exact(values)
    mean = values.sum() / len(values)
    return mean, *(((values - mean) ** power).sum() / len(values) for power in (2, 3))


def root(fraction):
    """Return the square root of a Fraction as a float, right to the last bit or so, at any scale."""
    if fraction == 0:
        return 0.0
    shift = (fraction.numerator.bit_length() - fraction.denominator.bit_length()) // 2
    scaled = fraction / Fraction(4) ** shift
    return float(np.ldexp(np.sqrt(float(scaled)), shift))


def skewness(values):
    """Return m3 / m2 ** 1.5 from exact moments; 0 for constant values."""
    _, second, third = exact_moments(values)
    if second == 0:
        return 0.0
    return float(np.copysign(np.sqrt(float(third**2 / second**3)), float(np.sign(third.numerator))))


def exact_detail_levels(values, low, high, levels, extension):
    """Decompose a sequence by y[n] = Σ taps[k] x[2 n + 1 − k], with half-sample reflection or with zeros.

    The taps are taken as the float64 numbers that they are.
    """
    signal, low, high = exact(values), exact(low), exact(high)
    mode = {"symmetric": "symmetric", "zero": "constant"}[extension]
    details = []
    for _ in range(levels):
        wide = np.pad(signal, len(low) - 1, mode)
        details.append(np.convolve(wide, high, "valid")[1::2])
        signal = np.convolve(wide, low, "valid")[1::2]
    return details
