"""pyrender without a display and under NumPy 2; all rendering imports it from here.

Five defects of pyrender 0.1.45 are dealt with: its import needs a viewer's X11 libraries; it uses a name
that NumPy has dropped; it draws in the order of a set, which makes pictures differ between runs; it closes
the display under other renderers; it looks for a window first.
"""

from __future__ import annotations

import os
import sys
import types
from typing import Any

os.environ.setdefault("PYOPENGL_PLATFORM", "egl")  # read when OpenGL is imported

import numpy as np

if not hasattr(np, "infty"):
    np.infty = np.inf  # type: ignore[attr-defined]  # noqa: NPY201

_viewer = types.ModuleType("pyrender.viewer")
_viewer.Viewer = None  # type: ignore[attr-defined]
sys.modules.setdefault("pyrender.viewer", _viewer)

import pyrender  # noqa: E402
from OpenGL import GL  # noqa: E402
from pyrender.renderer import Renderer  # noqa: E402
from pyrender.shader_program import ShaderProgramCache  # noqa: E402

# Solid things only: nothing here needs pyrender's order from back to front.
Renderer._sorted_mesh_nodes = lambda self, scene: sorted(scene.mesh_nodes, key=lambda node: node.name or "")


def _destroy(platform: Any) -> None:
    """Give up a context but not the display, which all renderers of a process share."""
    if platform._egl_context is not None:
        from OpenGL import EGL

        EGL.eglDestroyContext(platform._egl_display, platform._egl_context)
        platform._egl_context = None


if os.environ["PYOPENGL_PLATFORM"] == "egl":
    from pyrender.platforms.egl import EGLPlatform

    EGLPlatform.delete_context = _destroy

__all__ = ["GL", "ShaderProgramCache", "pyrender"]
