"""Filters of the pyramid and of the directional bank as numbers."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from importlib.util import find_spec
from typing import Any

import numpy as np

from .errors import FilterError
from .images import Array

_NINE = [0.037828455506995, -0.023849465019380, -0.11062440441842, 0.37740285561265]
_SEVEN = [-0.064538882628938, -0.040689417609558, 0.41809227322221]
_NINE_CENTRE, _SEVEN_CENTRE = 0.85269867900940, 0.78848561640566

_LADDER_HALVES = {
    "pkva6": (0.6261, -0.1794, 0.0688),
    "pkva8": (0.6302, -0.1924, 0.0930, -0.0403),
    "pkva12": (0.6300, -0.1930, 0.0972, -0.0526, 0.0272, -0.0144),
}
_LADDER_HALVES["pkva"] = _LADDER_HALVES["pkva12"]

DIRECTIONAL_FILTERS = ("pkva6", "pkva8", "pkva12", "pkva", "haar")
"""Allowed directional filters; `pkva` is the name of `pkva12` in the reference toolbox."""


@dataclass(frozen=True, eq=False)
class PyramidFilters:
    """A biorthogonal pair of symmetric lowpass filters; the taps of each sum to √2.

    Taps have no zero padding. A filter of odd length is centred on a sample, a filter of even length half
    a sample after it.
    """

    analysis: Array
    synthesis: Array

    @property
    def odd(self) -> bool:
        """Whether both filters are centred on a sample."""
        return len(self.analysis) % 2 == 1


@dataclass(frozen=True)
class LadderStep:
    """One step of a two-channel ladder: `target = gain * target + weight * F(other channel)`.

    `target` is the polyphase component that is replaced: 0 for the first, 1 for the second. `F` is
    separable in the coordinates of the lattice, with the same convolution taps along both axes. It reads
    `before` samples of the other component towards lower indices, and `after` towards higher indices.
    """

    target: int
    gain: float
    weight: float
    taps: tuple[float, ...]
    before: int
    after: int


def pywavelets() -> Any:
    """Return the package PyWavelets; raise `FilterError` if it is not installed."""
    try:
        import pywt
    except ModuleNotFoundError:
        raise FilterError(
            "Filters other than 9-7, 5-3 and haar come from PyWavelets, which is not installed; "
            "`pip install 'contourlets[wavelets]'` brings it."
        ) from None
    return pywt


def pyramid_filter_names() -> tuple[str, ...]:
    """Return all names that `pyramid_filters` allows; only three names without PyWavelets."""
    built_in = ("9-7", "5-3", "haar")
    if find_spec("pywt") is None:
        return built_in
    pywt = pywavelets()
    return (*built_in, *pywt.wavelist("bior"), *pywt.wavelist("rbio"))


def _read_only(values: Array) -> Array:
    """Make an array read-only and return the array."""
    values.setflags(write=False)
    return values


def _mirror(half: list[float], centre: float) -> Array:
    return np.array([*half, centre, *half[::-1]])


def _trim(taps: list[float]) -> Array:
    nonzero = np.flatnonzero(taps)
    return np.array(taps[nonzero[0] : nonzero[-1] + 1])


@cache
def pyramid_filters(name: str) -> PyramidFilters:
    """Return a pair of lowpass filters for the Laplacian pyramid.

    The taps are read-only. Names are `9-7` (Cohen, Daubechies & Feauveau 1992, with the 14 digits of the
    reference toolbox), `5-3` (Le Gall & Tabatabai 1988), `haar`, and the `bior…` and `rbio…` wavelets of
    PyWavelets. Raises `FilterError` if no pair has this name, or if PyWavelets is needed and not installed.
    """
    analysis, synthesis = _pyramid_taps(name)
    return PyramidFilters(_read_only(analysis), _read_only(synthesis))


def _pyramid_taps(name: str) -> tuple[Array, Array]:
    if name == "9-7":
        return _mirror(_NINE, _NINE_CENTRE), _mirror(_SEVEN, _SEVEN_CENTRE)
    if name == "5-3":
        return (
            np.array([-1.0, 2.0, 6.0, 2.0, -1.0]) / (4 * np.sqrt(2)),
            np.array([1.0, 2.0, 1.0]) / (2 * np.sqrt(2)),
        )
    if name == "haar":
        return np.full(2, np.sqrt(0.5)), np.full(2, np.sqrt(0.5))
    pywt = pywavelets()
    if name not in pyramid_filter_names():
        raise FilterError(
            f"No pyramid filter is called {name!r}; the names are 9-7, 5-3, haar and PyWavelets' "
            "bior… and rbio… wavelets."
        )
    wavelet = pywt.Wavelet(name)
    return _polish(_trim(wavelet.dec_lo), _trim(wavelet.rec_lo))


def _defects(analysis: Array, synthesis: Array) -> tuple[Array, Array]:
    """Return the errors of a pair in biorthogonality, sums and zeros at π, and their Jacobian."""
    n, m = len(analysis), len(synthesis)
    # Both filters have the same centre, so tap i meets tap i + (m − n)/2 + an even shift.
    reach = (n + m) // 4
    shifts = 2 * np.arange(-reach, reach + 1) + (m - n) // 2
    meets = np.arange(m) - np.arange(n)[:, None] == shifts[:, None, None]
    products = np.einsum("sij,i,j->s", meets, analysis, synthesis)
    by_analysis = np.einsum("sij,j->si", meets, synthesis)
    by_synthesis = np.einsum("sij,i->sj", meets, analysis)
    sums_a = np.stack([np.ones(n), (-1.0) ** np.arange(n)])
    sums_s = np.stack([np.ones(m), (-1.0) ** np.arange(m)])
    wanted = np.array([np.sqrt(2), 0.0])
    products -= shifts == (m - n) // 2
    defect = np.concatenate([products, sums_a @ analysis - wanted, sums_s @ synthesis - wanted])
    jacobian = np.block(
        [[by_analysis, by_synthesis], [sums_a, np.zeros((2, m))], [np.zeros((2, n)), sums_s]]
    )
    return defect, jacobian


def _polish(analysis: Array, synthesis: Array) -> tuple[Array, Array]:
    """Refine a pair to double precision, because some filters of PyWavelets have errors of 1e-12."""
    # Least-norm Newton steps, which change taps by no more than that error.
    for _ in range(2):
        defect, jacobian = _defects(analysis, synthesis)
        if np.abs(defect).max() < 1e-14:
            break
        change = np.linalg.lstsq(jacobian, -defect, rcond=1e-8)[0]
        analysis = analysis + change[: len(analysis)]
        synthesis = synthesis + change[len(analysis) :]
    return analysis, synthesis


@cache
def ladder_taps(name: str) -> Array:
    """Return the taps of the half-band prototype β of a `pkva` ladder: symmetric, of even length, read-only.

    S.-M. Phoong, C. W. Kim, P. P. Vaidyanathan, R. Ansari, "A new class of two-channel biorthogonal
    filter banks and wavelet bases", IEEE Trans. Signal Processing 43(3), 1995.
    """
    half = _LADDER_HALVES[name]
    return _read_only(np.array([*half[::-1], *half]))


@cache
def ladder_steps(name: str) -> tuple[LadderStep, LadderStep]:
    """Return the two ladder steps of a directional filter; raise `FilterError` if no filter has this name.

    With polyphase components p0 and p1, and F the prototype β with every other tap negated along
    both axes, `pkva` is y0 = (p0 − F p1)/√2, y1 = −√2 p1 − F y0 (Phoong et al. 1995, as in the
    reference toolbox). `haar` is the difference (p0 − p1)/√2 and the sum (p0 + p1)/√2, in lifting
    form.
    """
    if name not in DIRECTIONAL_FILTERS:
        raise FilterError(
            f"No directional filter is called {name!r}; the names are "
            f"{', '.join(DIRECTIONAL_FILTERS[:-1])} and {DIRECTIONAL_FILTERS[-1]}."
        )
    root = float(np.sqrt(2))
    if name == "haar":
        return (
            LadderStep(1, -1 / root, 1 / root, (1.0,), 0, 0),
            LadderStep(0, root, -1.0, (1.0,), 0, 0),
        )
    modulated = ladder_taps(name).copy()
    modulated[::2] *= -1
    taps = tuple(modulated.tolist())
    half = len(taps) // 2
    return (
        LadderStep(0, 1 / root, -1 / root, taps, half, half - 1),
        LadderStep(1, -root, -1.0, taps, half - 1, half),
    )


@cache
def diamond_filters(name: str) -> tuple[Array, Array]:
    """Compute the non-separable diamond filters that are equivalent to a `pkva` ladder.

    Returns h0 = √2 (δ + B)/2, the lowpass, and h1 = √2 (δ − B(δ + B)/2), where B = β(z1 z2) β(z1/z2). For
    β of n taps, h0 has 2 n − 1 rows and columns (23 for `pkva`), and h1 has 4 n − 3. Both are read-only.
    """
    if name not in _LADDER_HALVES:
        raise FilterError(
            f"Diamond filters need a ladder prototype, and {name!r} is none; the names are "
            f"{', '.join(_LADDER_HALVES)}."
        )
    beta = ladder_taps(name)
    n = len(beta)
    rows, columns = np.meshgrid(np.arange(n), np.arange(n), indexing="ij")
    product = np.zeros((2 * n - 1, 2 * n - 1))
    product[rows + columns, n - 1 + rows - columns] = np.outer(beta, beta)
    h0 = product / 2
    h0[n - 1, n - 1] += 0.5
    size = 4 * n - 3
    spectrum = np.fft.rfft2(product, (size, size)) * np.fft.rfft2(h0, (size, size))
    h1 = -np.fft.irfft2(spectrum, (size, size))
    h1[2 * n - 2, 2 * n - 2] += 1.0
    return _read_only(np.sqrt(2) * h0), _read_only(np.sqrt(2) * h1)
