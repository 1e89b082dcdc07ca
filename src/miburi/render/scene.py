"""One scene whose instances move: spheres at joints and ends, cylinders along bones, a grid in the ZX plane.

All spheres are one draw and all bones another; between two frames only the instances' poses go to the GPU.
Only the halves that face the eye are drawn.
"""

from __future__ import annotations

import ctypes
from collections.abc import Generator, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from miburi.errors import InputError
from miburi.kinematics import unit
from miburi.motion import Floats, Motion
from miburi.render import figure
from miburi.render.gl import GL, ShaderProgramCache, pyrender

Picture = NDArray[np.uint8]

BACKGROUND = (1.0, 1.0, 1.0, 1.0)
_GRID_COLOUR = (0.54, 0.57, 0.60, 1.0)
_COLOUR_LOCATION = 2  # of the attributes position, normal, colour


class Instances(pyrender.Primitive):  # type: ignore[misc]
    """A shape drawn many times in one call, each time with its own pose and colour.

    pyrender draws instances, but uploads their poses once and gives all of them one colour. Here `move`
    has the poses uploaded before the next draw, and colours are an attribute of the instance.

    Parameters
    ----------
    positions, normals : (n, 3)
        Vertices of the shape.
    indices : (m, 3)
        Its triangles.
    colours : (I, 4)
        From 0 to 1, red, green, blue, opacity.
    """

    def __init__(
        self, positions: Floats, normals: Floats, indices: NDArray[np.int64], colours: Floats
    ) -> None:
        super().__init__(
            positions,
            normals=normals,
            color_0=np.ones((len(positions), 4)),
            indices=indices,
            material=pyrender.MetallicRoughnessMaterial(),
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


def dome(rim: int = 20) -> tuple[Floats, Floats, NDArray[np.int64]]:
    """Vertices, normals and triangles of the half of a unit sphere that faces +z.

    What is turned to the eye is all that is seen of a sphere. A software rasteriser takes its time by the
    triangle, so there are many where the outline is (`rim`, an even number) and few inside, where normals
    make it round.
    """
    n = rim // 2
    angles = (np.arange(rim) * 2 * np.pi / rim, np.arange(n) * 2 * np.pi / n)
    rings = [
        np.stack([np.cos(a) * np.sin(t), np.sin(a) * np.sin(t), np.full_like(a, np.cos(t))], axis=1)
        for a, t in zip(angles, (np.pi / 2, 0.95), strict=True)
    ]
    vertices = np.concatenate([*rings, [[0.0, 0.0, 1.0]]])
    i = np.arange(n)
    outer, middle, next_outer = 2 * i, 2 * i + 1, (2 * i + 2) % rim
    inner, next_inner, pole = rim + i, rim + (i + 1) % n, np.full(n, rim + n)
    faces = (
        (outer, middle, inner),
        (middle, next_inner, inner),
        (middle, next_outer, next_inner),
        (inner, next_inner, pole),
    )
    return vertices, vertices.copy(), np.concatenate([np.stack(f, axis=1) for f in faces])


def trough(strips: int = 6) -> tuple[Floats, Floats, NDArray[np.int64]]:
    """Vertices, normals and triangles of the half of a cylinder that faces +z: radius 1, from y = 0 to y =
    1."""
    phi = np.linspace(-np.pi / 2, np.pi / 2, strips + 1)
    arc = np.stack([np.sin(phi), np.zeros_like(phi), np.cos(phi)], axis=-1)
    a = np.arange(strips)
    b = a + strips + 1
    faces = np.concatenate([np.stack([a, a + 1, b + 1], axis=1), np.stack([a, b + 1, b], axis=1)])
    return np.concatenate([arc, arc + np.array([0.0, 1.0, 0.0])]), np.concatenate([arc, arc]), faces


def dome_poses(points: Floats, radii: Floats, eye: Floats) -> Floats:
    """Poses (N, 4, 4) of domes at points (N, 3) with radii (N,), turned to the eye (3,)."""
    z = unit(eye - points, (0.0, 0.0, 1.0))
    x = unit(np.cross((0.0, 1.0, 0.0), z), (1.0, 0.0, 0.0))
    return _poses(x, np.cross(z, x), z, points, radii[:, None, None])


def trough_poses(tails: Floats, heads: Floats, radii: Floats, eye: Floats) -> Floats:
    """Poses (N, 4, 4) of half cylinders from tails to heads, each (N, 3), with radii (N,), turned to the
    eye (3,)."""
    along = heads - tails
    y = unit(along)
    x = np.cross(y, eye - tails)
    thin = np.linalg.norm(x, axis=1) < 1e-9  # a bone that points at the eye
    x[thin] = np.cross(y[thin], (1.0, 0.0, 0.0))
    x = unit(x, (1.0, 0.0, 0.0))
    r = radii[:, None]
    return _poses(x * r, along, np.cross(x, y) * r, tails, np.ones((len(along), 1, 1)))


def _poses(x: Floats, y: Floats, z: Floats, places: Floats, scale: Floats) -> Floats:
    poses = np.zeros((len(places), 4, 4))
    poses[:, :3, :3] = np.stack([x, y, z], axis=2) * scale
    poses[:, :3, 3] = places
    poses[:, 3, 3] = 1.0
    return poses


def frames(
    motions: Motion | Sequence[Motion],
    *,
    width: int = 640,
    height: int = 480,
    at: Sequence[int] | None = None,
) -> Generator[Picture, None, None]:
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
    renderer = offscreen(width, height)
    try:
        for k in range(len(group.points)) if at is None else at:
            points = group.points[k]
            tails, heads = points[group.bones[:, 0]], points[group.bones[:, 1]]
            spheres.move(dome_poses(points, group.radii, camera.places[k]))
            bones.move(trough_poses(tails, heads, group.bone_radii, camera.places[k]))
            scene.set_pose(eye, pose(camera.rotation, camera.places[k]))
            yield renderer.render(scene)
    finally:
        renderer.delete()


def offscreen(width: int, height: int) -> Any:
    """pyrender's renderer with shaders and a way to read pictures of our own (its own take most of a
    frame's time)."""
    renderer = pyrender.OffscreenRenderer(width, height)
    inner = renderer._renderer
    inner._program_cache = ShaderProgramCache(str(Path(__file__).parent / "shaders"))
    inner._read_main_framebuffer = lambda scene, flags: _read(inner)
    return renderer


def build(group: figure.Group, aspect: float, camera: figure.Camera) -> tuple[Any, Instances, Instances, Any]:
    """The scene: instances of spheres and of bones, and a grid; the shaders hold the lights.

    Returns
    -------
    scene, spheres, bones, eye
        pyrender's scene, what moves in it, and the camera's node.
    """
    scene = pyrender.Scene(bg_color=BACKGROUND)
    spheres = Instances(*dome(), group.colours)
    bones = Instances(*trough(), group.bone_colours)
    for name, primitive in (
        ("1 spheres", spheres),
        ("2 bones", bones),
        ("3 grid", _grid(figure.grid(group))),
    ):
        scene.add(pyrender.Mesh([primitive]), name=name)
    far = float(np.linalg.norm(camera.places[0] - group.points[0].mean(axis=0)))
    eye = pyrender.PerspectiveCamera(yfov=figure.FIELD, aspectRatio=aspect, znear=0.05 * far, zfar=20.0 * far)
    node = scene.add(eye, pose=pose(camera.rotation, camera.places[0]), name="camera")
    return scene, spheres, bones, node


def _grid(lines: Floats) -> Any:
    """The grid as one primitive of lines."""
    points = lines.reshape(-1, 3)
    colours = np.tile(_GRID_COLOUR, (len(points), 1))
    return pyrender.Primitive(points, color_0=colours, material=pyrender.MetallicRoughnessMaterial(), mode=1)


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
