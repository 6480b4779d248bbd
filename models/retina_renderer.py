"""An eye by MuJoCo's own renderer, where the machine has EGL or OSMesa."""

import mujoco
import numpy as np

from models.errors import BodyError
from models.retina import Image, RetinaOptions, camera_id, degrade, focal_length_px


class RenderedEye:
    """Real rendering without shadows and reflections: flat colours are what features are found by.

    Set `MUJOCO_GL` to `egl` or `osmesa` before Python starts.
    """

    def __init__(self, model: mujoco.MjModel, camera: str, options: RetinaOptions) -> None:
        self.options = options
        self._camera = camera_id(model, camera)
        self.focal_px = focal_length_px(model, self._camera, options)
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

    def see(self, data: mujoco.MjData, rng: np.random.Generator | None = None) -> Image:
        """The image at `data`; see `models.retina.Eye`."""
        self._renderer.update_scene(data, camera=self._camera)
        flags = self._renderer.scene.flags
        flags[mujoco.mjtRndFlag.mjRND_SHADOW] = flags[mujoco.mjtRndFlag.mjRND_REFLECTION] = False
        return degrade(self._renderer.render().astype(np.float32), self.options, rng)

    def close(self) -> None:
        """Give the graphics context back."""
        self._renderer.close()
