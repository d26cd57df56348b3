"""3D replays: record a simulation, or joint angles alone, and play them in the page.

    recorder = replay.Recorder(world)
    while world.time < 40.0:
        world.step(torque)
        recorder.capture()
    recorder.replay(title="dig and load", alt="The bucket digs ... and fills the truck.")

The last line of a cell shows the player: drag to look around, space to play, ? for all keys. It is
one self-contained piece of HTML without network access, so that it plays in JupyterLab, in exported
pages and offline. `recording` describes what a replay can show, for other scenes than the machine.
"""

from backhoe.view.replay.page import Replay
from backhoe.view.replay.recorder import Recorder, from_joints

__all__ = ["Recorder", "Replay", "from_joints"]
