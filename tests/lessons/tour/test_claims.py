"""What lesson 00 says in words, where no other test stands behind it."""

from pathlib import Path

import nbformat
import numpy as np

from backhoe.arm import kinematics
from backhoe.machine.provenance import provenance

NOTEBOOKS = Path(__file__).resolve().parents[3] / "notebooks"


def test_every_other_lesson_opens_with_the_circle_of_the_data_and_its_own_part_lit():
    lessons = sorted(NOTEBOOKS.glob("[0-9]*.ipynb"))[1:]
    assert len(lessons) >= 7
    for path in lessons:
        code = [c.source for c in nbformat.read(path, as_version=4).cells if c.cell_type == "code"]
        assert "data_way(lit=" in code[1], path.name


def test_lowering_the_boom_changes_which_joint_moves_the_teeth_most():
    def busiest(boom):
        q = np.radians([-90.0, boom, -10.0, 0.0])
        tips = kinematics.forward_kinematics(np.vstack((q, q + np.radians(np.eye(4)))))[:, :3, 3]
        return np.linalg.norm(tips[1:] - tips[0], axis=1).argmax()

    assert (busiest(20.0), busiest(-30.0)) == (0, 1)


def test_lengths_masses_and_inertias_of_the_links_come_from_the_thesis_and_the_rest_says_ours():
    for name, *_, source in provenance():
        link, _, quantity = name.partition(".")
        if link in ("boom", "stick", "bucket") and quantity in ("length", "mass", "inertia"):
            assert source.startswith("Mastalli 2013"), name
        assert source.startswith(("Mastalli 2013", "ours")), name
