"""Images of something round that is pressed, and files of them."""

import numpy as np
from PIL import Image


def pressed(centre, radius, size=(20, 37)):
    y, x = np.mgrid[: size[0], : size[1]]
    return np.clip(1.2 - np.hypot(y - centre[0], x - centre[1]) / radius, 0, 1)


def written(folder, kind, name, image, bits=8):
    (folder / kind).mkdir(parents=True, exist_ok=True)
    scaled = image * (2**bits - 1)
    Image.fromarray(scaled.astype(np.uint8 if bits == 8 else np.uint16)).save(folder / kind / name)
