"""A retina: what a camera of a simulated body shows, as pixels and nothing else.

An `Eye` turns physics into an image, `(height, width, 3)` bytes of red, green and blue. Two ways to make one stand in
`models.renderers`: MuJoCo's ray casting, which needs no graphics (`rays`), and MuJoCo's own renderer over EGL or OSMesa
(`mujoco`). Both are pinhole cameras with square pixels; the centre of pixel (row i, column j) is the image point
u = j, v = i (columns to the right, rows downwards), so the optical axis meets the image at ((W - 1)/2, (H - 1)/2).
"""

from abc import ABC, abstractmethod
from dataclasses import dataclass

import mujoco
import numpy as np
import numpy.typing as npt
from scipy import ndimage

from models.errors import BodyError, unknown

Image = npt.NDArray[np.uint8]
"""`(height, width, 3)` red, green, blue."""
Levels = npt.NDArray[np.float32]
"""The same in levels 0 to 255, not yet whole."""


@dataclass(frozen=True)
class RetinaOptions:
    """How an eye sees. Lengths on the image are pixels; `fovy_deg=None` takes the camera's own vertical field of view.

    `noise` is the standard deviation of white Gaussian noise on every channel of every pixel as a fraction of full
    scale (0.02 = 5.1 of 255 levels); `blur` the standard deviation of a Gaussian blur; `antialias` averages
    several samples in pixels that an edge crosses.
    """

    width: int = 160
    height: int = 120
    fovy_deg: float | None = None
    noise: float = 0.0
    blur: float = 0.0
    antialias: bool = True


def camera_id(model: mujoco.MjModel, name: str) -> int:
    """The camera called `name`; raises `BodyError` for a scene without it."""
    names = [model.camera(i).name for i in range(model.ncam)]
    if not names:
        raise BodyError(
            f"no camera {name!r}: this scene has no cameras at all; a body that sees needs <camera name=...>"
        )
    if name not in names:
        raise BodyError(unknown("camera", name, names))
    return names.index(name)


class Eye(ABC):
    """One camera of one body.

    Raises:
        BodyError: a scene without a camera of this name.
    """

    def __init__(self, model: mujoco.MjModel, camera: str, options: RetinaOptions) -> None:
        self.options = options
        self._model, self._camera = model, camera_id(model, camera)
        fovy_deg = float(model.cam_fovy[self._camera]) if options.fovy_deg is None else options.fovy_deg
        self.focal_px = 0.5 * options.height / float(np.tan(np.deg2rad(fovy_deg) / 2.0))
        """Focal length in pixels: (height/2) / tan(fovy/2)."""

    @abstractmethod
    def _colour(self, data: mujoco.MjData) -> Levels:
        """The noiseless, sharp image at `data`."""

    def see(self, data: mujoco.MjData, rng: np.random.Generator | None = None) -> Image:
        """The image at `data` (after `mj_forward` or `mj_step`): blur, then noise, then eight bits.

        Raises:
            BodyError: noise without an `rng`.
        """
        colour, options = self._colour(data), self.options
        if options.blur > 0.0:
            colour = ndimage.gaussian_filter(colour, (options.blur, options.blur, 0.0), mode="nearest", truncate=3.0)
        if options.noise > 0.0:
            if rng is None:
                raise BodyError("a noisy retina needs a random generator: eye.see(data, rng)")
            noise = rng.standard_normal(colour.shape, dtype=np.float32)
            noise *= np.float32(255.0 * options.noise)
            noise += colour
            colour = np.clip(noise, 0.0, 255.0, out=noise)
        return (colour + np.float32(0.5)).astype(np.uint8)
