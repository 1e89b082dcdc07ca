"""One scene whose instances move: spheres at joints and ends, cylinders along bones, a grid in the ZX plane.

All spheres are one draw and all bones another; between two frames only the instances' poses go to the GPU.
"""

from __future__ import annotations

import ctypes
from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from miburi.errors import InputError
from miburi.motion import Floats, Motion
from miburi.render import figure
from miburi.render.gl import GL, pyrender

Picture = NDArray[np.uint8]

BACKGROUND = (1.0, 1.0, 1.0, 1.0)
_GRID_COLOUR = (0.62, 0.65, 0.68, 1.0)
_COLOUR_LOCATION = 2  # of the attributes position, normal, colour


class Instances(pyrender.Primitive):  # type: ignore[misc]
    """A shape drawn many times in one call, each time with its own pose and colour.

    pyrender draws instances, but uploads their poses once and gives all of them one colour. Here `move` has the
    poses uploaded before the next draw, and colours are an attribute of the instance.

    Parameters
    ----------
    positions, normals : (n, 3)
        Vertices of the shape.
    indices : (m, 3)
        Its triangles.
    colours : (I, 4)
        From 0 to 1, red, green, blue, opacity.
    """

    def __init__(self, positions: Floats, normals: Floats, indices: NDArray[np.int64], colours: Floats) -> None:
        material = pyrender.MetallicRoughnessMaterial(metallicFactor=0.0, roughnessFactor=0.65)
        super().__init__(
            positions,
            normals=normals,
            color_0=np.ones((len(positions), 4)),
            indices=indices,
            material=material,
            poses=np.tile(np.eye(4), (len(colours), 1, 1)),
        )
        self._colours = np.ascontiguousarray(colours, dtype=np.float32)
        self._moved = False

    def move(self, poses: NDArray[np.floating[Any]]) -> None:
        """New poses, (I, 4, 4), for the next frame."""
        self._poses = poses
        self._moved = True

    def _add_to_context(self) -> None:
        super()._add_to_context()
        self._pose_buffer = self._buffers[1]  # 0: vertices, 1: poses, 2: triangles
        GL.glBindVertexArray(self._vaid)
        buffer = GL.glGenBuffers(1)
        self._buffers.append(buffer)
        GL.glBindBuffer(GL.GL_ARRAY_BUFFER, buffer)
        GL.glBufferData(GL.GL_ARRAY_BUFFER, self._colours.nbytes, self._colours, GL.GL_STATIC_DRAW)
        GL.glVertexAttribPointer(_COLOUR_LOCATION, 4, GL.GL_FLOAT, GL.GL_FALSE, 16, ctypes.c_void_p(0))
        GL.glVertexAttribDivisor(_COLOUR_LOCATION, 1)
        GL.glBindVertexArray(0)

    def _bind(self) -> None:  # the one call before each draw
        super()._bind()
        if self._moved:
            columns = np.ascontiguousarray(np.transpose(self._poses, (0, 2, 1)), dtype=np.float32)
            GL.glBindBuffer(GL.GL_ARRAY_BUFFER, self._pose_buffer)
            GL.glBufferData(GL.GL_ARRAY_BUFFER, columns.nbytes, columns, GL.GL_STREAM_DRAW)
            self._moved = False


def sphere(around: int = 24, down: int = 12) -> tuple[Floats, Floats, NDArray[np.int64]]:
    """Vertices, normals and triangles of a sphere of radius 1."""
    theta, phi = np.meshgrid(np.linspace(0, np.pi, down + 1), np.linspace(0, 2 * np.pi, around + 1), indexing="ij")
    points = np.stack([np.sin(theta) * np.sin(phi), np.cos(theta), np.sin(theta) * np.cos(phi)], axis=-1)
    vertices = points.reshape(-1, 3)
    return vertices, vertices.copy(), _quads(down, around)


def cylinder(around: int = 16) -> tuple[Floats, Floats, NDArray[np.int64]]:
    """Vertices, normals and triangles of an open cylinder of radius 1 about y, from y = 0 to y = 1."""
    phi = np.linspace(0, 2 * np.pi, around + 1)
    ring = np.stack([np.sin(phi), np.zeros_like(phi), np.cos(phi)], axis=-1)
    vertices = np.concatenate([ring + (0.0, 1.0, 0.0), ring])
    return vertices, np.concatenate([ring, ring]), _quads(1, around)


def _quads(rows: int, columns: int) -> NDArray[np.int64]:
    """Triangles of a grid of vertices, rows + 1 by columns + 1, counter-clockwise from outside."""
    r, c = np.meshgrid(np.arange(rows), np.arange(columns), indexing="ij")
    a = (r * (columns + 1) + c).ravel()
    b = a + columns + 1
    return np.concatenate([np.stack([a, b, b + 1], axis=1), np.stack([a, b + 1, a + 1], axis=1)])


def sphere_poses(points: Floats, radii: Floats) -> Floats:
    """Poses (N, 4, 4) of spheres at points (N, 3) with radii (N,)."""
    poses = np.zeros((len(points), 4, 4))
    poses[:, 0, 0] = poses[:, 1, 1] = poses[:, 2, 2] = radii
    poses[:, :3, 3] = points
    poses[:, 3, 3] = 1.0
    return poses


def bone_poses(tails: Floats, heads: Floats, radii: Floats) -> Floats:
    """Poses (N, 4, 4) of unit cylinders from tails to heads, each (N, 3), with radii (N,)."""
    along = heads - tails
    length = np.maximum(np.linalg.norm(along, axis=1, keepdims=True), 1e-9)
    y = along / length
    # square to the bone: with the axis that it points along least
    helper = np.eye(3)[np.argmin(np.abs(y), axis=1)]
    x = np.cross(y, helper)
    x /= np.maximum(np.linalg.norm(x, axis=1, keepdims=True), 1e-9)
    poses = np.zeros((len(along), 4, 4))
    poses[:, :3, 0] = x * radii[:, None]
    poses[:, :3, 1] = along
    poses[:, :3, 2] = np.cross(x, y) * radii[:, None]
    poses[:, :3, 3] = tails
    poses[:, 3, 3] = 1.0
    return poses


def frames(
    motions: Motion | Sequence[Motion],
    *,
    width: int = 640,
    height: int = 480,
    at: Sequence[int] | None = None,
) -> Iterator[Picture]:
    """Pictures of figures that move.

    Parameters
    ----------
    motions
        One motion, or several that are shown side by side; those that end early stay in their last pose.
    width, height
        Pixels.
    at
        Frames to show; absent: all. The camera is the same as for the whole motion.

    Yields
    ------
    (height, width, 3) uint8
        Red, green, blue.

    Raises
    ------
    InputError
        There is nothing to show, or a picture is too small.
    """
    shown = [motions] if isinstance(motions, Motion) else list(motions)
    if not shown or any(len(m) == 0 for m in shown):
        raise InputError("nothing to show: a motion without frames")
    if width < 16 or height < 16:
        raise InputError(f"pictures of {width} × {height} pixels, expected 16 × 16 or more")
    group = figure.group(shown)
    camera = figure.camera(group, width / height)
    scene, spheres, bones, eye = build(group, width / height, camera)
    renderer = pyrender.OffscreenRenderer(width, height)
    renderer._renderer._read_main_framebuffer = lambda scene, flags: _read(renderer._renderer)
    try:
        for k in range(len(group.points)) if at is None else at:
            points = group.points[k]
            spheres.move(sphere_poses(points, group.radii))
            bones.move(bone_poses(points[group.bones[:, 0]], points[group.bones[:, 1]], group.bone_radii))
            scene.set_pose(eye, pose(camera.rotation, camera.places[k]))
            yield renderer.render(scene)
    finally:
        renderer.delete()


def build(group: figure.Group, aspect: float, camera: figure.Camera) -> tuple[Any, Instances, Instances, Any]:
    """The scene: instances of spheres and of bones, a grid, lights that stand with the camera.

    Returns
    -------
    scene, spheres, bones, eye
        pyrender's scene, what moves in it, and the camera's node.
    """
    scene = pyrender.Scene(bg_color=BACKGROUND, ambient_light=(0.35, 0.35, 0.35))
    spheres = Instances(*sphere(), _linear(group.colours))
    bones = Instances(*cylinder(), _linear(group.bone_colours))
    for name, primitive in (("1 spheres", spheres), ("2 bones", bones), ("3 grid", _grid(figure.grid(group)))):
        scene.add(pyrender.Mesh([primitive]), name=name)
    far = float(np.linalg.norm(camera.places[0] - group.points[0].mean(axis=0)))
    eye = pyrender.PerspectiveCamera(yfov=figure.FIELD, aspectRatio=aspect, znear=0.05 * far, zfar=20.0 * far)
    node = scene.add(eye, pose=pose(camera.rotation, camera.places[0]), name="camera")
    for name, direction, strength in (("key", (-0.5, 0.8, 0.9), 3.2), ("fill", (0.9, 0.1, 0.5), 1.2)):
        light = pyrender.DirectionalLight(color=np.ones(3), intensity=strength)
        scene.add(light, pose=pose(figure.look(camera.rotation @ np.array(direction)), np.zeros(3)), name=name)
    return scene, spheres, bones, node


def _linear(colours: Floats) -> Floats:
    """Colours (…, 4) as light, of which pyrender takes the 2.2nd root at the end."""
    return np.asarray(colours**2.2)


def _grid(lines: Floats) -> Any:
    """The grid as one primitive of lines."""
    points = lines.reshape(-1, 3)
    material = pyrender.MetallicRoughnessMaterial(metallicFactor=0.0, roughnessFactor=1.0)
    return pyrender.Primitive(
        points, color_0=np.tile(_linear(np.array(_GRID_COLOUR)), (len(points), 1)), material=material, mode=1
    )


def _read(renderer: Any) -> Picture:
    """A finished picture: as pyrender reads it, without the depths that nobody looks at."""
    width, height = renderer._main_fb_dims
    GL.glBindFramebuffer(GL.GL_READ_FRAMEBUFFER, renderer._main_fb_ms)
    GL.glBindFramebuffer(GL.GL_DRAW_FRAMEBUFFER, renderer._main_fb)
    box = (0, 0, width, height)
    GL.glBlitFramebuffer(*box, *box, GL.GL_COLOR_BUFFER_BIT, GL.GL_LINEAR)
    GL.glBindFramebuffer(GL.GL_READ_FRAMEBUFFER, renderer._main_fb)
    GL.glPixelStorei(GL.GL_PACK_ALIGNMENT, 1)  # any width
    picture = np.empty((height, width, 3), np.uint8)
    GL.glReadPixels(*box, GL.GL_RGB, GL.GL_UNSIGNED_BYTE, picture)
    return np.ascontiguousarray(picture[::-1])


def pose(rotation: Floats, place: Floats) -> Floats:
    """A pose (4, 4)."""
    matrix = np.eye(4)
    matrix[:3, :3], matrix[:3, 3] = rotation, place
    return matrix
