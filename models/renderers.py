"""Every way to make an eye."""

import mujoco
import numpy as np

from models.errors import BodyError, unknown
from models.retina import Eye, Levels, RetinaOptions
from models.retina_rays import RayEye


class RenderedEye(Eye):
    """MuJoCo's own renderer, where the machine has EGL or OSMesa.

    Without shadows and reflections: flat colours are what features are found by. Set `MUJOCO_GL` to `egl` or `osmesa`
    before Python starts.
    """

    def __init__(self, model: mujoco.MjModel, camera: str, options: RetinaOptions) -> None:
        super().__init__(model, camera, options)
        if options.fovy_deg is not None:
            model.cam_fovy[self._camera] = options.fovy_deg  # MuJoCo's renderer has no other way to be told
        model.vis.global_.offwidth = max(model.vis.global_.offwidth, options.width)
        model.vis.global_.offheight = max(model.vis.global_.offheight, options.height)
        model.vis.quality.offsamples = 4 if options.antialias else 0
        try:
            self._renderer = mujoco.Renderer(model, options.height, options.width)
        except Exception as error:  # the bindings raise whatever the graphics library raises
            raise BodyError(
                f"no rendering here ({error}): install EGL or OSMesa and set MUJOCO_GL=egl or osmesa, "
                "or use the renderer 'rays'"
            ) from error

    def _colour(self, data: mujoco.MjData) -> Levels:
        self._renderer.update_scene(data, camera=self._camera)
        flags = self._renderer.scene.flags
        flags[mujoco.mjtRndFlag.mjRND_SHADOW] = flags[mujoco.mjtRndFlag.mjRND_REFLECTION] = False
        return np.asarray(self._renderer.render(), np.float32)


RENDERERS: dict[str, type[Eye]] = {"rays": RayEye, "mujoco": RenderedEye}
"""Name -> the eye at a camera of a body."""


def open_eye(model: mujoco.MjModel, camera: str, options: RetinaOptions | None = None, renderer: str = "rays") -> Eye:
    """The eye at `camera`, made by one of `RENDERERS`."""
    if renderer not in RENDERERS:
        raise BodyError(unknown("renderer", renderer, RENDERERS))
    return RENDERERS[renderer](model, camera, options or RetinaOptions())
