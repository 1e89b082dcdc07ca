"""Takes read as their groups say."""

from dataclasses import replace

import numpy as np
import pytest

from miburi.config import Group
from miburi.errors import InputError
from miburi.figures import PERSON
from miburi.formats import bvh
from miburi.motion import Motion
from miburi.recordings import read_take
from miburi.takes import Take


@pytest.fixture
def take(tmp_path):
    """A rest pose, then a second of somebody whose arms swing."""
    t = np.arange(60) / 60
    q = np.zeros((61, 14, 4))
    q[..., 3] = 1
    half = 0.6 + 0.2 * np.sin(3 * t)
    for joint in ("l_shoulder", "r_shoulder"):
        q[1:, PERSON.index(joint), 0], q[1:, PERSON.index(joint), 3] = np.sin(half), np.cos(half)
    bvh.write(tmp_path / "swing.bvh", Motion(PERSON, 60.0, np.zeros((61, 3)), q))
    return Take("swing", "all", str(tmp_path / "swing.bvh"), 0, 1.0)


def group(**settings):
    return Group(folder=".", files=["*.bvh"], **settings).model_dump()


def test_rest_poses_are_left_out_unless_asked_for(take):
    assert len(read_take(take, group())) == 60
    assert len(read_take(take, group(drop_rest_pose=False))) == 61
    assert len(read_take(take, group(skip_frames=1))) == 60
    assert len(read_take(take, group(skip_frames=11, drop_rest_pose=False))) == 50


def test_frame_rates_of_single_takes(take):
    assert read_take(take, group()).fps == 60
    assert read_take(take, group(fps=120)).fps == 120
    assert read_take(take, group(fps=120, rates={"swing": 25})).fps == 25
    assert read_take(replace(take, name="other"), group(fps=120, rates={"swing": 25})).fps == 120


def test_more_frames_skipped_than_there_are(take):
    with pytest.raises(InputError, match=r"swing\.bvh: has 61 frames, skip_frames is 61"):
        read_take(take, group(skip_frames=61))
