"""The same bits, whatever else is in the batch."""

import numpy as np

from contourlets import Contourlet, directional_deviations
from visuohaptic.attention.model import attend
from visuohaptic.attention.parameters import AttentionParameters
from visuohaptic.features.imprint_shape import describe_imprint_shape
from visuohaptic.geometry.raycasting import RayCaster
from visuohaptic.recognition.sequence_features import summarise_signals
from visuohaptic.scene.parameters import Scene
from visuohaptic.sensor.gallery import hard_probes
from visuohaptic.sensor.parameters import SensorParameters
from visuohaptic.sensor.touching import touch
from visuohaptic.stability.findings import Finding

NAME = "determinism/batch split of kernels"


def coefficients(images):
    """Give all contourlet coefficients of each image in a row."""
    return Contourlet(levels=(4,)).forward(images).ravel()


def moments(images):
    """Give deviation, root mean square and skewness of each image's pixels."""
    return summarise_signals(images.reshape(len(images), -1), 1)


KERNELS = {
    "contourlet deviations": directional_deviations,
    "contourlet coefficients": coefficients,
    "shape of imprints": describe_imprint_shape,
    "moments": moments,
}


def kernel_batches(generator):
    """Describe images together, in parts, and in another order."""
    count = int(generator.integers(2, 71))
    images = generator.random((count, 32, 32)).astype(generator.choice(["float32", "float64"]))
    cuts = np.sort(generator.integers(0, count, 3))
    order = generator.permutation(count)
    for name, kernel in KERNELS.items():
        together = kernel(images)
        parts = [kernel(part) for part in np.split(images, cuts) if len(part)]
        shuffled = kernel(images[order])[np.argsort(order)]
        wrong = [not np.array_equal(together, other) for other in (np.concatenate(parts), shuffled)]
        yield Finding(NAME, wrong, f"{name}, {count} images")


def touch_batches(generator):
    """Touch a hard place many times together, and one by one."""
    probes = hard_probes()
    probe = probes[generator.integers(len(probes))]
    caster = RayCaster(probe.surface)
    points = np.array(probe.point) + 0.01 * generator.normal(size=(12, 3))
    normals = np.array(probe.normal) + 0.1 * generator.normal(size=(12, 3))
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    together = touch(caster, points, normals, SensorParameters(), Scene())
    wrong = []
    for row in generator.permutation(12)[:4]:
        rows = slice(row, row + 1)
        alone = touch(caster, points[rows], normals[rows], SensorParameters(), Scene())
        same = np.array_equal(alone.images[0], together.images[row])
        same &= bool(alone.size[0] == together.size[row])
        wrong.append(not same or alone.contact_state[0] != together.contact_state[row])
    yield Finding(NAME, wrong, f"touches on {probe.name}")


def view_batches(generator):
    """Attend to views together, and one by one."""
    count = int(generator.integers(2, 6))
    shape = (count, 32, 32)
    views = {
        "colour": generator.random((*shape, 3)).astype(np.float32),
        "mask": generator.random(shape) < 0.8,
        "point": generator.uniform(-1, 1, (*shape, 3)),
        "normal": np.broadcast_to([0.0, 0.0, 1.0], (*shape, 3)),
        "face": np.zeros(shape, dtype=np.int64),
        "curvature": generator.random(shape).astype(np.float32),
    }
    together = attend(**views, parameters=AttentionParameters())
    wrong = []
    for row, found in enumerate(together):
        view = {name: values[row : row + 1] for name, values in views.items()}
        alone = attend(**view, parameters=AttentionParameters())[0]
        same = np.array_equal(alone.saliency, found.saliency)
        wrong.append(not same or not np.array_equal(alone.scanpath.rows, found.scanpath.rows))
    yield Finding(NAME, wrong, f"attention to {count} views")
