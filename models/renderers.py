"""Every way to make an eye."""

from collections.abc import Callable

import mujoco

from models.errors import BodyError, unknown
from models.retina import Eye, RetinaOptions
from models.retina_rays import RayEye
from models.retina_renderer import RenderedEye

RENDERERS: dict[str, Callable[[mujoco.MjModel, str, RetinaOptions], Eye]] = {"rays": RayEye, "mujoco": RenderedEye}
"""Name -> the eye at a camera of a body."""


def open_eye(model: mujoco.MjModel, camera: str, options: RetinaOptions | None = None, renderer: str = "rays") -> Eye:
    """The eye at `camera`, made by one of `RENDERERS`."""
    if renderer not in RENDERERS:
        raise BodyError(unknown("renderer", renderer, RENDERERS))
    return RENDERERS[renderer](model, camera, options or RetinaOptions())
