"""What lesson 07 says of its exercises beside their oracles."""

import numpy as np

from backhoe.lessons.ekf.exercises import motion
from backhoe.localisation import drives, fusion


def test_cycles_one_after_another_are_the_librarys_pose_filter_with_a_yaw():
    drive = drives.load("rectangle")
    theirs = fusion.pose_filter(drive, heading="yaw", slip=False)
    steps = fusion.increments(drive)
    x, P = drive.truth[0], np.diag(fusion.START_STD) ** 2
    for k, dt in enumerate(steps.dt[:600]):
        M = drives.NOISE.encoder * dt / drives.SAMPLE_RATE
        x, P = motion.cycle(x, P, steps.left[k], steps.right[k], steps.yaw[k], M, 0.02)
    np.testing.assert_allclose(x, theirs.pose[600], atol=1e-9)
    np.testing.assert_allclose(P, theirs.covariance[600], atol=1e-12)
