import subprocess
import sys

import numpy as np
import pytest

from contourlets import EXTENSIONS, Contourlet, LevelsError, contourlet_operator


@pytest.mark.parametrize("extension", EXTENSIONS)
@pytest.mark.parametrize(("dtype", "tolerance"), [(np.float64, 1e-13), (np.float32, 1e-5)])
def test_operator_is_the_ladder(extension, dtype, tolerance, rng):
    transform = Contourlet((2, 3), "5-3", "pkva8", extension)
    images = rng.standard_normal((2, 5, 16, 24)).astype(dtype)
    operator = contourlet_operator(transform, (16, 24), dtype)
    found, expected = operator.forward(images), transform.forward(images)
    for band, reference in zip(found.bands, expected.bands, strict=True):
        assert band.shape == reference.shape
        assert band.dtype == dtype
        np.testing.assert_allclose(band, reference, atol=10 * tolerance)
    rebuilt = transform.inverse(found)
    np.testing.assert_allclose(rebuilt, images, atol=10 * tolerance)
    adjoint = operator.adjoint(expected)
    np.testing.assert_allclose(adjoint, transform.adjoint(expected), atol=50 * tolerance)


def test_an_image_does_not_depend_on_its_batch(rng):
    operator = contourlet_operator(Contourlet((3,)), (16, 16))
    images = rng.standard_normal((1000, 16, 16))
    whole = operator.forward(images).ravel()
    for count in (1, 2, 3, 5, 7, 80):
        for chosen in (slice(count), slice(-count, None)):
            few = operator.forward(images[chosen]).ravel()
            np.testing.assert_array_equal(few, whole[chosen])


def test_operator_is_built_once():
    transform = Contourlet((3,))
    operator = contourlet_operator(transform, (16, 16))
    assert operator is contourlet_operator(Contourlet((3,)), (16, 16), "float64")
    assert not operator.matrix.flags.writeable


@pytest.mark.slow
def test_products_do_not_depend_on_the_number_of_threads():
    program = (
        "import numpy as np, hashlib\n"
        "from contourlets import Contourlet, contourlet_operator\n"
        "x = np.random.default_rng(1).standard_normal((70, 32, 32))\n"
        "operator = contourlet_operator(Contourlet((4,)), (32, 32))\n"
        "print(hashlib.sha256(operator.forward(x).ravel().tobytes()).hexdigest())\n"
    )
    digests = {
        subprocess.run(
            [sys.executable, "-c", program],
            env={"PYTHONPATH": ":".join(sys.path), "OPENBLAS_NUM_THREADS": threads},
            check=True,
            capture_output=True,
            text=True,
        ).stdout
        for threads in ("1", "2")
    }
    assert len(digests) == 1


def test_too_large_or_wrong_sizes_are_refused():
    with pytest.raises(LevelsError, match="128 × 128"):
        contourlet_operator(Contourlet((4,)), (128, 128))
    operator = contourlet_operator(Contourlet((2,)), (8, 8))
    with pytest.raises(LevelsError, match="8 × 8 pixels, not 16 × 8"):
        operator.forward(np.zeros((16, 8)))
