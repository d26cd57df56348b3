"""The parts of one autonomous backhoe, a module for each concept.

Nothing is imported here: `from backhoe import kinematics` loads what it names and no more.
"""

__version__ = "0.1.0"
