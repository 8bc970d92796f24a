"""Right answers in exact rationals. Nothing here imports the library."""

from fractions import Fraction

import numpy as np


def _exact(values):
    return [Fraction(float(value)) for value in values]


def _minus(p, q):
    return [x - y for x, y in zip(p, q, strict=True)]


def _cross(p, q):
    return [
        p[1] * q[2] - p[2] * q[1],
        p[2] * q[0] - p[0] * q[2],
        p[0] * q[1] - p[1] * q[0],
    ]


def _dot(p, q):
    return sum((x * y for x, y in zip(p, q, strict=True)), Fraction(0))


def near(triangles, origin, direction):
    """Give the triangles that a line passes within a thousandth of, by float64."""
    corners = triangles - origin
    sides = np.einsum("fkd,d->fk", np.cross(corners, np.roll(corners, -1, axis=1)), direction)
    edges = np.linalg.norm(triangles - np.roll(triangles, -1, axis=1), axis=2)
    slack = 1e-3 * edges.max(axis=1, keepdims=True) * np.linalg.norm(direction)
    return triangles[(sides >= -slack).all(axis=1) | (sides <= slack).all(axis=1)]


def exact_first_hit(triangles, origin, direction):
    """Give the exact distance to the first triangle, rims included, as a Fraction; None for a miss."""
    triangles = near(triangles, np.asarray(origin), np.asarray(direction))
    o, d = _exact(origin), _exact(direction)
    best = None
    for triangle in triangles:
        corner, first, second = (_exact(point) for point in triangle)
        a, b = _minus(first, corner), _minus(second, corner)
        normal = _cross(a, b)
        determinant = -_dot(d, normal)
        if determinant == 0:
            continue
        s = _minus(o, corner)
        t = _dot(s, normal) / determinant
        q = _cross(s, d)
        u, v = _dot(q, b) / determinant, -_dot(q, a) / determinant
        if t >= 0 and u >= 0 and v >= 0 and u + v <= 1 and (best is None or t < best):
            best = t
    return best


def exact_moments(values):
    """Give mean, variance (population) and third moment about the mean, as Fractions."""
    exact = _exact(values)
    count = len(exact)
    mean = sum(exact, Fraction(0)) / count
    deviations = [value - mean for value in exact]
    return (
        mean,
        sum((deviation**2 for deviation in deviations), Fraction(0)) / count,
        sum((deviation**3 for deviation in deviations), Fraction(0)) / count,
    )


def root(fraction):
    """Give the square root of a Fraction as a float, right to the last bit or so, at any scale."""
    if fraction == 0:
        return 0.0
    shift = (fraction.numerator.bit_length() - fraction.denominator.bit_length()) // 2
    scaled = fraction / Fraction(4) ** shift
    return float(np.ldexp(np.sqrt(float(scaled)), shift))


def skewness(values):
    """Give m3 / m2 ** 1.5 from exact moments; 0 for constant values."""
    _, second, third = exact_moments(values)
    if second == 0:
        return 0.0
    square = third**2 / second**3
    return float(np.copysign(np.sqrt(float(square)), float(np.sign(third.numerator))))


def exact_detail_levels(values, low, high, levels, extension):
    """Decompose a sequence with half-sample symmetric extension or with zeros, in Fractions.

    The taps are taken as the float64 numbers that they are.
    """
    taps_low, taps_high = _exact(low), _exact(high)
    length = len(taps_low)
    details = []
    signal = _exact(values)
    for _ in range(levels):
        count = len(signal)

        def at(index, signal=signal, count=count):
            if extension == "zero" and not 0 <= index < count:
                return Fraction(0)
            index %= 2 * count
            return signal[index] if index < count else signal[2 * count - 1 - index]

        places = range((count + length - 1) // 2)
        details.append(
            [
                sum((taps_high[k] * at(2 * n + 1 - k) for k in range(length)), Fraction(0))
                for n in places
            ]
        )
        signal = [
            sum((taps_low[k] * at(2 * n + 1 - k) for k in range(length)), Fraction(0))
            for n in places
        ]
    return details
