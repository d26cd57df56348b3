"""The numbers of the machine, each in one place; `provenance` says where they come from."""

from dataclasses import replace

from backhoe.machine.description import (
    BACKHOE,
    JOINTS,
    Base,
    Joint,
    Link,
    Machine,
    Shell,
    Swing,
    Tracks,
)

__all__ = [
    "BACKHOE",
    "JOINTS",
    "Base",
    "Joint",
    "Link",
    "Machine",
    "Shell",
    "Swing",
    "Tracks",
    "replace",
]
