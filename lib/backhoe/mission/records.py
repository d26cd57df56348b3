"""What the runs of both missions keep: who was swapped in, and the frames of the replay."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, ClassVar

from backhoe.machine import Machine

if TYPE_CHECKING:
    from backhoe.view.replay import Recorder, Replay


@dataclass(frozen=True, eq=False, kw_only=True)
class Record:
    """`swapped` names the student's parts; `machine` and `backend` are those of its world."""

    swapped: tuple[str, ...]
    machine: Machine | None
    backend: str
    recorder: Recorder | None = field(default=None, repr=False)
    SHOWN: ClassVar[tuple[str, str, str]]
    """The call that makes it, and what its replay is called and shows."""

    def replay(self, title: str | None = None, alt: str | None = None) -> Replay:
        """The run as a 3D replay for the notebook.

        Args:
            title: what stands above it; default the mission's name.
            alt: what it shows, for readers who do not see it; default a few words.

        Raises:
            ValueError: the run was not recorded, or title or alt is empty.
        """
        call, its_title, its_alt = self.SHOWN
        if self.recorder is None:
            raise ValueError(f"this run was not recorded: call {call}(record=True)")
        return self.recorder.replay(
            title=its_title if title is None else title,
            alt=its_alt if alt is None else alt,
            **self._drawn(),
        )

    def _drawn(self) -> dict[str, object]:
        """What else the replay shows; see `view.replay.Recorder.replay`."""
        return {}


def recorder_of(plant: object) -> Recorder:
    """What keeps the frames of a simulation, or of the one that a plant drives in.

    Raises:
        ValueError: there is nothing to look at.
    """
    from backhoe.view.replay import Recorder

    seen = getattr(plant, "world", plant)
    if not (hasattr(seen, "machine") or hasattr(seen, "wheel_angles")):
        raise ValueError(
            "record=True needs something to look at: the machine on its tracks or a rover of "
            f"simulation.open_rover, got {type(plant).__name__}"
        )
    return Recorder(seen)
