"""Rendering a hand: one draw for all spheres and one for all bones, against a scene whose nodes move one
by one.

Prints a table of milliseconds a frame (median) and the ratio to ours, and how much the pictures differ.
Peers:

* `nodes, pyrender's own`: one mesh for each sphere, bone and the grid, of trimesh's shapes, pyrender's
  shaders, two lights and its reading of depths, as its documentation has it; each frame sets every node's
  pose;
* `nodes, whole shapes`: the same with our shaders and without depths;
* `nodes, our shapes`: our half shapes as well; only the instances are left out.

The last columns compare pictures with ours; pyrender's own shaders light the figure differently.

Run: python benchmarks/bench_render.py [frames]
"""

from __future__ import annotations

import sys
import time
from collections.abc import Callable, Iterator

import numpy as np
import trimesh

from miburi.formats.columns import shares
from miburi.formats.glove import motion as hand
from miburi.motion import Motion
from miburi.perform import janken
from miburi.render import figure, scene
from miburi.render.gl import pyrender

WIDTH, HEIGHT = 640, 480
Frames = Callable[[Motion], Iterator[np.ndarray]]


def wearer() -> Motion:
    """The first recording of the simulated glove wearer."""
    counts, _ = janken.perform(2011)["rock_scissors"]
    gains = np.array([s.get("gain", 0.0) for s in janken.calibration().values()])
    offsets = np.array([s.get("offset", 0.0) for s in janken.calibration().values()])
    weights = np.stack([shares("wearer", name, s) for name, s in janken.calibration().items()])
    return hand(((counts - offsets) * gains) @ weights, janken.FPS)


def tube(around: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Vertices, normals and triangles of a whole cylinder from y = 0 to y = 1."""
    phi = np.arange(around) * 2 * np.pi / around
    ring = np.stack([np.sin(phi), 0 * phi, np.cos(phi)], axis=1)
    a = np.arange(around)
    b = (a + 1) % around
    faces = np.concatenate(
        [np.stack([a, b, b + around], axis=1), np.stack([a, b + around, a + around], axis=1)]
    )
    return np.concatenate([ring, ring + np.array([0, 1, 0])]), np.concatenate([ring, ring]), faces


def one_by_one(motion: Motion, *, shapes: bool, shaders: bool) -> Iterator[np.ndarray]:
    """Pictures from a scene in which every sphere and bone is a node."""
    group = figure.group([motion])
    camera = figure.camera(group, WIDTH / HEIGHT)
    whole, _, _, eye = scene.build(group, WIDTH / HEIGHT, camera)
    for node in list(whole.mesh_nodes):
        if "grid" not in node.name:
            whole.remove_node(node)
    renderer = scene.offscreen(WIDTH, HEIGHT) if shaders else pyrender.OffscreenRenderer(WIDTH, HEIGHT)
    ball, rod = scene.dome(), scene.trough()
    if not shapes:
        sphere = trimesh.creation.icosphere(subdivisions=3, radius=1.0)
        ball, rod = (sphere.vertices, sphere.vertices, sphere.faces), tube(32)
    if not shaders:
        for place in ((-0.5, 0.8, 0.9), (0.9, 0.1, 0.5)):
            light = pyrender.DirectionalLight(color=np.ones(3), intensity=3.0)
            whole.add(light, pose=scene.pose(figure.look(camera.rotation @ np.array(place)), np.zeros(3)))

    def node(k: int, kind: str, shape: tuple, colour: np.ndarray) -> object:
        part = pyrender.Primitive(
            shape[0],
            normals=shape[1],
            indices=shape[2],
            color_0=np.tile(colour, (len(shape[0]), 1)),
            material=pyrender.MetallicRoughnessMaterial(metallicFactor=0.0),
            mode=4,
        )
        return whole.add(pyrender.Mesh([part]), name=f"{kind} {k:03d}")

    balls = [node(k, "1 sphere", ball, c) for k, c in enumerate(group.colours)]
    rods = [node(k, "2 bone", rod, c) for k, c in enumerate(group.bone_colours)]
    for k, points in enumerate(group.points):
        place = camera.places[k]
        tails, heads = points[group.bones[:, 0]], points[group.bones[:, 1]]
        poses = scene.dome_poses(points, group.radii, place)
        for n, pose in zip(balls, poses, strict=True):
            whole.set_pose(n, pose)
        for n, pose in zip(rods, scene.trough_poses(tails, heads, group.bone_radii, place), strict=True):
            whole.set_pose(n, pose)
        whole.set_pose(eye, scene.pose(camera.rotation, place))
        picture = renderer.render(whole)
        yield picture if shaders else picture[0]
    renderer.delete()


def in_turn(peers: dict[str, Frames], motion: Motion) -> dict[str, tuple[float, np.ndarray]]:
    """Median milliseconds a frame (the first three left out) and the pictures, frame by frame in turn."""
    going = {name: frames(motion) for name, frames in peers.items()}
    seconds: dict[str, list[float]] = {name: [] for name in peers}
    pictures: dict[str, list[np.ndarray]] = {name: [] for name in peers}
    for _ in range(len(motion)):
        for name, frames in going.items():
            start = time.perf_counter()
            pictures[name].append(next(frames))
            seconds[name].append(time.perf_counter() - start)
    return {name: (1000 * float(np.median(seconds[name][3:])), np.stack(pictures[name])) for name in peers}


def figure_of(pictures: np.ndarray) -> np.ndarray:
    """Where the coloured figure is: grid and background have no colour."""
    return np.ptp(pictures.astype(np.int16), axis=3) > 30


def main() -> None:
    count = int(sys.argv[1]) if len(sys.argv) > 1 else 120
    motion = wearer()[:count]
    peers: dict[str, Frames] = {
        "two draws (ours)": scene.frames,
        "nodes, our shapes": lambda m: one_by_one(m, shapes=True, shaders=True),
        "nodes, whole shapes": lambda m: one_by_one(m, shapes=False, shaders=True),
        "nodes, pyrender's own": lambda m: one_by_one(m, shapes=False, shaders=False),
    }
    rows = in_turn(peers, motion)
    ours, pictures = rows["two draws (ours)"]
    print(f"hand, {len(motion)} frames of {WIDTH} x {HEIGHT}, EGL")
    print(f"{'':24}{'ms/frame':>10}{'frames/s':>10}{'ratio':>8}{'outline IoU':>13}{'mean diff.':>12}")
    drawn = figure_of(pictures)
    for name, (ms, others) in rows.items():
        other = figure_of(others)
        overlap = (drawn & other).sum() / (drawn | other).sum()
        difference = np.abs(pictures.astype(np.int16) - others).mean()
        print(f"{name:24}{ms:10.2f}{1000 / ms:10.0f}{ms / ours:8.1f}{overlap:13.4f}{difference:12.3f}")


if __name__ == "__main__":
    main()
