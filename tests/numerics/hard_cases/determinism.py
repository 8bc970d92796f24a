"""The same bits, whatever else is in the batch."""

import numpy as np

from contourlets import Contourlet, directional_deviations
from visuohaptic.attention.model import attend
from visuohaptic.attention.parameters import AttentionParameters
from visuohaptic.features.imprint_shape import describe_imprint_shape
from visuohaptic.geometry.curvature import unit_vectors
from visuohaptic.geometry.raycasting import RayCaster
from visuohaptic.recognition.sequence_features import summarise_signals
from visuohaptic.scene.parameters import Scene
from visuohaptic.sensor.example_shapes import hard_probes
from visuohaptic.sensor.parameters import SensorParameters
from visuohaptic.sensor.sensing import touch
from visuohaptic.stability.findings import Finding

NAME = "determinism/batch split of kernels"
KERNELS = {
    "contourlet deviations": directional_deviations,
    "contourlet coefficients": lambda images: Contourlet(levels=(4,)).forward(images).ravel(),
    "shape of imprints": describe_imprint_shape,
    "moments": lambda images: summarise_signals(images.reshape(len(images), -1), 1),
}


def compare_batches(kernel, values, generator, label):
    """Want a kernel to give the same for each of n values together, in parts, and in another order."""
    order, cuts = generator.permutation(len(values)), generator.integers(0, len(values), 3)
    together = kernel(values)
    parts = [kernel(part) for part in np.split(values, np.sort(cuts)) if len(part)]
    in_parts, shuffled = np.concatenate(parts), kernel(values[order])[np.argsort(order)]
    wrong = [not np.array_equal(together, other) for other in (in_parts, shuffled)]
    return Finding(NAME, wrong, label)


def kernel_batches(generator):
    """Describe images."""
    count = int(generator.integers(2, 71))
    images = generator.random((count, 32, 32)).astype(generator.choice(["float32", "float64"]))
    for name, kernel in KERNELS.items():
        yield compare_batches(kernel, images, generator, f"{name}, {count} images")


def touch_batches(generator):
    """Touch a hard place and its surroundings."""
    probes = hard_probes()
    probe = probes[generator.integers(len(probes))]
    caster = RayCaster(probe.surface)
    points = np.array(probe.point) + 0.01 * generator.normal(size=(12, 3))
    normals = unit_vectors(np.array(probe.normal) + 0.1 * generator.normal(size=(12, 3)))

    def feel(poses):
        felt = touch(caster, poses[:, 0], poses[:, 1], SensorParameters(), Scene())
        states = [hash(state) for state in felt.contact_state]
        return np.column_stack([felt.images.reshape(len(poses), -1), felt.size, states])

    poses = np.stack([points, normals], axis=1)
    yield compare_batches(feel, poses, generator, f"touches on {probe.name}")


def view_batches(generator):
    """Attend to views."""
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

    def look(rows):
        some = {name: values[rows] for name, values in views.items()}
        found = attend(**some, parameters=AttentionParameters())
        return np.stack([[*one.saliency.ravel(), *one.scanpath.rows] for one in found])

    yield compare_batches(look, np.arange(count), generator, f"attention to {count} views")
