"""Slow twins of the readers: 4 × 4 matrices, one value, one joint, one frame after the other."""

import gzip
import math
import re

import numpy as np


def text_of(path):
    with open(path, "rb") as file:
        data = file.read()
    return (gzip.decompress(data) if data[:2] == b"\x1f\x8b" else data).decode("latin-1")


def about(axis, degrees):
    """4 × 4 rotation about x, y or z."""
    c, s = math.cos(math.radians(degrees)), math.sin(math.radians(degrees))
    m = np.eye(4)
    a, b = {"x": (1, 2), "y": (2, 0), "z": (0, 1)}[axis]
    m[a, a], m[a, b], m[b, a], m[b, b] = c, -s, s, c
    return m


def shift(vector):
    m = np.eye(4)
    m[:3, 3] = vector
    return m


def bvh(path):
    """Places of joints and ends of a BVH file, its own unit and axes: {name: (T, 3)}, ends as 'joint/end'."""
    words = text_of(path).split()
    nodes, stack, i = [], [], 1
    while words[i] != "MOTION":
        word = words[i]
        if word in ("ROOT", "JOINT", "End"):
            name = words[i + 1] if word != "End" else nodes[stack[-1]]["name"] + "/end"
            nodes.append(
                {"name": name, "parent": stack[-1] if stack else None, "channels": [], "offset": None}
            )
            i += 2
        elif word == "{":
            stack.append(len(nodes) - 1)
            i += 1
        elif word == "}":
            stack.pop()
            i += 1
        elif word == "OFFSET":
            nodes[stack[-1]]["offset"] = [float(w) for w in words[i + 1 : i + 4]]
            i += 4
        elif word == "CHANNELS":
            n = int(words[i + 1])
            nodes[stack[-1]]["channels"] = words[i + 2 : i + 2 + n]
            i += 2 + n
    assert words[i + 1] == "Frames:"
    frames = int(words[i + 2])
    values = [float(w) for w in words[i + 6 :]]
    width = sum(len(n["channels"]) for n in nodes)
    assert len(values) == frames * width
    places = {n["name"]: [] for n in nodes}
    for t in range(frames):
        row = values[t * width : (t + 1) * width]
        world, at = [], 0
        for node in nodes:
            offset, turn = list(node["offset"]), np.eye(4)
            for channel in node["channels"]:
                if channel.endswith("position"):
                    offset["XYZ".index(channel[0])] = row[at]
                else:
                    turn = turn @ about(channel[0].lower(), row[at])
                at += 1
            parent = np.eye(4) if node["parent"] is None else world[node["parent"]]
            world.append(parent @ shift(offset) @ turn)
            places[node["name"]].append(world[-1][:3, 3])
    return {k: np.array(v) for k, v in places.items()}


def acclaim(asf, amc, first=None):
    """Places where the bones of an AMC begin and (as 'bone/tail') end, in the ASF's unit: {name: (T, 3)}."""
    skeleton = re.sub(r"#.*", "", text_of(asf))
    bones, parents = {}, {}
    for block in re.findall(
        r"begin\s(.*?)\send", skeleton.split(":bonedata")[1].split(":hierarchy")[0], re.S
    ):
        field = {}
        for line in block.strip().split("\n"):
            words = line.split()
            if words and not words[0].startswith("("):
                field[words[0]] = words[1:]
        bones[field["name"][0]] = field
    for line in skeleton.split(":hierarchy")[1].split("\n"):
        words = line.split()
        for child in words[1:]:
            parents[child] = words[0]
    root = {w[0]: w[1:] for w in map(str.split, skeleton.split(":root")[1].split(":")[0].split("\n")) if w}

    def axes(words):
        """Rotation about fixed axes in the order given: the first one is applied first."""
        m = np.eye(4)
        for axis in words[-1].lower():
            m = about(axis, float(words["xyz".index(axis)])) @ m
        return m

    frames, frame = [], None
    for line in text_of(amc).split("\n"):
        words = line.split()
        if words and words[0].isdigit():
            frame = {}
            frames.append(frame)
        elif words and frame is not None:
            frame[words[0]] = [float(w) for w in words[1:]]
    order = ["root"]
    while len(order) < len(bones) + 1:
        order += [c for c, p in parents.items() if p in order and c not in order]
    places = {}
    for values in frames[:first]:
        begins, world, tails = {}, {}, {}
        for name in order:
            dof = root["order"] if name == "root" else bones[name].get("dof", [])
            c = axes([*root["orientation"], *root["axis"]] if name == "root" else bones[name]["axis"])
            m, moved = np.eye(4), np.zeros(3)
            for which, value in zip(dof, values.get(name, []), strict=True):
                if which[0].lower() == "r":
                    m = about(which[1].lower(), value) @ m
                else:
                    moved["xyz".index(which[1].lower())] += value
            turn = c @ m @ np.linalg.inv(c)
            if name == "root":
                begins[name] = np.array([float(w) for w in root["position"]]) + moved
                world[name], tails[name] = turn, begins[name]
            else:
                parent = parents[name]
                bone = np.array([float(w) for w in bones[name]["direction"]]) * float(
                    bones[name]["length"][0]
                )
                begins[name] = tails[parent]
                world[name] = world[parent] @ turn
                tails[name] = begins[name] + world[name][:3, :3] @ bone
            places.setdefault(name, []).append(begins[name])
            places.setdefault(name + "/tail", []).append(tails[name])
    return {k: np.array(v) for k, v in places.items()}
