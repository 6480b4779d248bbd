"""Experiments: configuration in, metrics, figures and a recording out."""

import os

# Before NumPy is loaded: small matrices gain nothing from threads, and one thread gives the same bytes on any machine.
for _name in ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS", "VECLIB_MAXIMUM_THREADS"):
    os.environ[_name] = "1"
os.environ.setdefault("MUJOCO_GL", "disabled")  # dm_control must not look for a display
