import numpy as np
import pytest
from contourlet_definition import frequency_directions

from contourlets.directional import analyse_directions
from contourlets.lattice import EXTENSIONS, directional_tables


def bands_of(image, depth, name, extension):
    tables = directional_tables(image.shape, depth, name, extension)
    return [band[..., 0] for band in analyse_directions(image.reshape(-1, 1).copy(), tables)]


def matrix_of(shape, depth, name, extension):
    tables = directional_tables(shape, depth, name, extension)
    bands = analyse_directions(np.eye(shape[0] * shape[1]), tables)
    return np.concatenate([band.reshape(-1, shape[0] * shape[1]) for band in bands])


def check_bands(found, expected, atol=1e-12):
    assert len(found) == len(expected)
    for band, reference in zip(found, expected, strict=True):
        np.testing.assert_allclose(band, reference, atol=atol)


@pytest.mark.parametrize("depth", range(6))
@pytest.mark.parametrize("name", ["pkva", "pkva6"])
def test_bands_on_the_torus_are_filtered_by_their_frequency_responses(depth, name, rng):
    cases = [(shape, "circular") for shape in ((32, 32), (64, 32), (32, 64))]
    # The toolbox's arrays have no seam yet.
    cases += [((32, 32), "periodic")] if depth in (1, 2) else []
    for shape, extension in cases:
        image = rng.standard_normal(shape)
        expected = frequency_directions(image, depth, name)
        check_bands(bands_of(image, depth, name, extension), expected)


@pytest.mark.parametrize("depth", [3, 4])
def test_bands_have_their_frequency_responses_away_from_seams_and_borders(depth, rng):
    image = rng.standard_normal((256, 256))
    expected = frequency_directions(image, depth, "pkva6")
    places = {e: directional_tables(image.shape, depth, "pkva6", e).bands for e in EXTENSIONS}
    for extension in EXTENSIONS:
        found = bands_of(image, depth, "pkva6", extension)
        for number, (band, response) in enumerate(zip(found, expected, strict=True)):
            reference = response
            if extension == "symmetric":
                # There every band starts at its first pixel in the image; elsewhere the toolbox's
                # delays put some a sample later along the finer axis.
                circular = places["circular"][number]
                order = np.argsort(circular, axis=None).reshape(circular.shape)
                np.testing.assert_array_equal(circular.ravel()[order], places[extension][number])
                reference = response.ravel()[order]
            flat = number < 2 ** (depth - 1)
            inner = np.s_[11:-11, 40:-40] if flat else np.s_[40:-40, 11:-11]
            assert band[inner].size > 300
            np.testing.assert_allclose(band[inner], reference[inner], atol=1e-12)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("extension", "least", "largest"), [("periodic", 0.331, 3.021), ("symmetric", 0.230, 4.693)]
)
def test_singular_values_of_sixteen_bands_are_the_known_ones(extension, least, largest):
    matrix = matrix_of((32, 32), 4, "pkva", extension)
    values = np.sqrt(np.linalg.eigvalsh(matrix.T @ matrix))
    assert values[[0, -1]] == pytest.approx([least, largest], abs=5e-4)


@pytest.mark.parametrize("extension", ["periodic", "circular"])
def test_haar_bank_is_orthonormal(extension):
    matrix = matrix_of((16, 16), 4, "haar", extension)
    np.testing.assert_allclose(matrix @ matrix.T, np.eye(256), atol=1e-13)


@pytest.mark.parametrize("depth", range(2, 6))
def test_circular_haar_bank_commutes_with_shifts_by_the_decimation_step(depth, rng):
    image = rng.standard_normal((64, 64))
    bands = bands_of(image, depth, "haar", "circular")
    step = max(2, 2 ** (depth - 1))
    for shift in [(step, 0), (0, step), (3 * step, -step)]:
        turns = [[s * n // 64 for s, n in zip(shift, band.shape, strict=True)] for band in bands]
        expected = [np.roll(band, turn, (0, 1)) for band, turn in zip(bands, turns, strict=True)]
        shifted = bands_of(np.roll(image, shift, (0, 1)), depth, "haar", "circular")
        check_bands(shifted, expected, atol=1e-13)
