"""Compares differences of pictures with those of scikit-image, for noise, scenes and their changes.

pictures.py SIMILARITY
"""

from __future__ import annotations

import pathlib
import subprocess
import sys
import tempfile

import numpy as np
from PIL import Image
from skimage.metrics import structural_similarity

PAIRS = 60

# The pairs cover differences from below to above these.
SMALL = 0.01
LARGE = 0.5


def main() -> int:
    """Compares all; exits at the first difference."""
    generator = np.random.default_rng(23)
    with tempfile.TemporaryDirectory() as folder:
        pairs = [save(pathlib.Path(folder), number, generator) for number in range(PAIRS)]
        lines = "".join(f"{got};{reference}\n" for got, reference in pairs)
        run = subprocess.run([sys.argv[1]], input=lines, capture_output=True, text=True, check=True)
        found = [float(line) for line in run.stdout.splitlines()]
        expected = [1 - similarity(*pair) for pair in pairs]
    if len(found) != PAIRS:
        sys.exit(f"{len(found)} results")
    for number, (result, wanted) in enumerate(zip(found, expected, strict=True)):
        if abs(result - wanted) > 1e-9:
            sys.exit(f"pair {number}: {result}, expected {wanted}")
    if min(found) > SMALL or max(found) < LARGE:
        sys.exit(f"the differences are: {min(found)} to {max(found)}")
    print(f"ok: {PAIRS} pairs of pictures, differences {min(found):.3g} to {max(found):.3g}")
    return 0


def similarity(got: pathlib.Path, reference: pathlib.Path) -> float:
    """The structural similarity by the definition of spec/golden.md."""
    pictures = [np.asarray(Image.open(path).convert("RGB")) for path in (got, reference)]
    return float(
        structural_similarity(
            *pictures,
            channel_axis=2,
            gaussian_weights=True,
            sigma=1.5,
            use_sample_covariance=False,
            data_range=255,
        )
    )


def save(
    folder: pathlib.Path, number: int, generator: np.random.Generator
) -> tuple[pathlib.Path, pathlib.Path]:
    """Two pictures: a scene with noise, a moved box or other colours; every third is noise."""
    height, width = (int(side) for side in generator.integers(11, 120, 2))
    rows, columns = np.mgrid[0:height, 0:width]
    scene = np.stack([rows * 2, columns * 2, (rows + columns) % 32 * 8], axis=2) % 256
    if number % 3 == 0:
        scene = generator.integers(0, 256, (height, width, 3))
    changed = scene.copy()
    match number % 5:
        case 0:
            changed = generator.integers(0, 256, (height, width, 3))
        case 1:
            changed = scene + generator.integers(-2, 3, scene.shape)
        case 2:
            changed[height // 2 :, width // 2 :] = (200, 30, 30)
        case 3:
            changed = scene[:, :, ::-1]
        case _:
            changed = np.roll(scene, 3, axis=1)
    paths = (folder / f"{number}-got.png", folder / f"{number}-reference.png")
    for path, pixels in zip(paths, (changed, scene), strict=True):
        Image.fromarray(np.clip(pixels, 0, 255).astype(np.uint8)).save(path)
    return paths


if __name__ == "__main__":
    sys.exit(main())
