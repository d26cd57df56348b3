"""PyBullet, imported and connected without its banner.

The C library prints its build time on import; here the process's own file descriptors point to
nothing meanwhile, so that notebooks and logs stay the same on every machine.
"""

from __future__ import annotations

import os
import sys
import tempfile
import threading
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from functools import partial
from importlib import import_module
from pathlib import Path
from types import ModuleType

import numpy as np
from numpy.typing import NDArray

MISSING = (
    "PyBullet is not installed. On Linux x86-64 with Python up to 3.11: pip install pybullet. "
    "On Windows and macOS: pip install pybullet_arm64. With conda: conda install -c conda-forge "
    'pybullet. Or go on without it: open_world(backend="analytic")'
)

_silencing = threading.Lock()


@contextmanager
def silence() -> Iterator[None]:
    """Send what C code prints to stdout and stderr into nothing."""
    with _silencing:
        sys.stdout.flush()
        sys.stderr.flush()
        kept = [os.dup(1), os.dup(2)]
        nothing = os.open(os.devnull, os.O_WRONLY)
        try:
            os.dup2(nothing, 1)
            os.dup2(nothing, 2)
            yield
        finally:
            for target, source in zip((1, 2), kept, strict=True):
                os.dup2(source, target)
                os.close(source)
            os.close(nothing)


def pybullet() -> ModuleType:
    """The PyBullet module.

    Raises:
        ImportError: it is not installed; the message says how to install it.
    """
    if sys.modules.get("pybullet") is not None:
        return sys.modules["pybullet"]
    try:
        with silence():
            return import_module("pybullet")
    except ImportError as error:
        raise ImportError(MISSING) from error


class Server:
    """A new headless physics server: PyBullet's functions for it alone, and PyBullet's constants.

    Raises:
        ImportError: PyBullet is not installed.
        RuntimeError: the server does not start.
    """

    def __init__(self) -> None:
        self._library = pybullet()
        with silence():
            self.client = self._library.connect(self._library.DIRECT)
        if self.client < 0:
            raise RuntimeError(
                "PyBullet could not start another physics server: close some simulations"
            )

    def __getattr__(self, name: str) -> object:
        thing = getattr(self._library, name)
        if callable(thing):
            thing = partial(thing, physicsClientId=self.client)
        setattr(self, name, thing)
        return thing

    def load_urdf(
        self, text: str, at: Sequence = (0, 0, 0), turned: Sequence = (0, 0, 0, 1), **how: object
    ) -> int:
        """The body that a URDF describes, with its inertias, `at` [m], turned by a quaternion."""
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / "body.urdf"
            path.write_text(text)
            return self.loadURDF(
                str(path), at, turned, flags=self.URDF_USE_INERTIA_FROM_FILE, **how
            )

    def free(self, body: int, **contact: float) -> None:
        """Take PyBullet's damping off all links of a body, and set what else they have."""
        for link in range(-1, self.getNumJoints(body)):
            self.changeDynamics(
                body, link, linearDamping=0, angularDamping=0, jointDamping=0, **contact
            )

    def switch_off(self, body: int, joints: Sequence[int]) -> None:
        """Take PyBullet's velocity motors off joints of a body."""
        nothing = [0.0] * len(joints)
        self.setJointMotorControlArray(body, joints, self.VELOCITY_CONTROL, forces=nothing)

    def push(self, body: int, joints: Sequence[int], torques: NDArray) -> None:
        """Advance by one step with forces in joints of a body [N or N m]."""
        self.setJointMotorControlArray(body, joints, self.TORQUE_CONTROL, forces=torques.tolist())
        self.stepSimulation()

    def joints(self, body: int) -> dict[str, int]:
        """Index of each joint of a body by its name."""
        count = range(self.getNumJoints(body))
        return {self.getJointInfo(body, index)[1].decode(): index for index in count}

    def place(self, body: int, T: NDArray) -> None:
        """Put the base of a body at a pose, shape (4, 4)."""
        self.resetBasePositionAndOrientation(body, T[:3, 3].tolist(), quaternion(T[:3, :3]))


def quaternion(R: NDArray) -> list[float]:
    """The rotation as a quaternion xyzw, for the frames of an upright arm."""
    diagonal = np.array([R[0, 0], R[1, 1], R[2, 2]])
    squares = np.array([*(1 + 2 * diagonal - diagonal.sum()), 1 + diagonal.sum()])
    largest = int(np.argmax(squares))
    q = np.empty(4)
    w = np.array([R[2, 1] - R[1, 2], R[0, 2] - R[2, 0], R[1, 0] - R[0, 1]])
    if largest == 3:
        q[:3], q[3] = w, squares[3]
    else:
        i, j, k = largest, (largest + 1) % 3, (largest + 2) % 3
        q[i], q[3] = squares[i], w[i]
        q[j], q[k] = R[i, j] + R[j, i], R[i, k] + R[k, i]
    return (q / np.linalg.norm(q)).tolist()
