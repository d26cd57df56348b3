"""Files that are damaged, foreign or too large: refused with a reason, at no cost in memory."""

from __future__ import annotations

import tracemalloc

import numpy as np
import pytest

from backhoe.perception.octree import OccupancyOctree, files

HEAD = {ending: first + b"\n# made by hand\n#\n" for ending, first in files.FIRST_LINES.items()}


@pytest.fixture(scope="module")
def tree() -> OccupancyOctree:
    rng = np.random.default_rng(0)
    tree = OccupancyOctree(0.1)
    tree.insert_scan(rng.normal(size=(40, 3)), [0.05, 0.05, 0.05])
    return tree


def by_hand(
    ending: str, data: bytes, size: object, res: object = 0.1, kind: str = "OcTree"
) -> bytes:
    return HEAD[ending] + f"id {kind}\nsize {size}\nres {res}\ndata\n".encode() + data


def refused(path, content: bytes, words: str) -> None:
    path.write_bytes(content)
    with pytest.raises(ValueError, match=words):
        OccupancyOctree.load(path)


@pytest.mark.parametrize("ending", [".ot", ".bt"])
def test_what_is_saved_is_loaded(tree, ending, tmp_path):
    path = tmp_path / f"map{ending}"
    tree.save(path)
    again = OccupancyOctree.load(path, hit=0.9)
    points = np.random.default_rng(1).normal(size=(2000, 3))
    old, new = tree.log_odds(points), again.log_odds(points)
    if ending == ".ot":
        np.testing.assert_array_equal(old, new)
    else:
        np.testing.assert_array_equal(np.isnan(old), np.isnan(new))
        np.testing.assert_array_equal(np.sign(old), np.sign(new))
    assert again.resolution == 0.1 and again.hit == 0.9


def test_a_resolution_of_many_digits_is_kept(tmp_path):
    tree = OccupancyOctree(0.1234567891)
    tree.insert_scan([[1, 1, 1]], [0, 0, 0])
    tree.save(tmp_path / "map.ot")
    assert OccupancyOctree.load(tmp_path / "map.ot").resolution == 0.1234567891


def test_a_map_goes_on_after_it_was_loaded(tree, tmp_path):
    tree.save(tmp_path / "map.ot")
    both = [tree, OccupancyOctree.load(tmp_path / "map.ot")]
    rng = np.random.default_rng(2)
    points = rng.normal(size=(300, 3))
    for one in both:
        one.insert_scan(points, [0, 0, 0])
    for first, second in zip(both[0].leaves(), both[1].leaves(), strict=True):
        np.testing.assert_array_equal(first, second)


@pytest.mark.parametrize("ending", [".ot", ".bt"])
def test_a_file_cut_anywhere_is_refused(tree, ending, tmp_path):
    whole = tmp_path / f"whole{ending}"
    tree.save(whole)
    content = whole.read_bytes()
    for end in [*range(0, 160, 3), *range(160, len(content), 97), len(content) - 1]:
        refused(tmp_path / f"cut{ending}", content[:end], "must|damaged")
    refused(tmp_path / f"cut{ending}", content + b"ab", "damaged")


@pytest.mark.parametrize("ending", [".ot", ".bt"])
def test_a_file_with_any_byte_changed_is_a_map_or_is_refused(tree, ending, tmp_path):
    path = tmp_path / f"map{ending}"
    tree.save(path)
    content, rng = path.read_bytes(), np.random.default_rng(3)
    for _ in range(150):
        wrong = bytearray(content)
        wrong[rng.integers(len(wrong))] = rng.integers(256)
        path.write_bytes(wrong)
        try:
            again = OccupancyOctree.load(path)
        except ValueError:
            continue
        assert np.isfinite(again.leaves().log_odds).all()


@pytest.mark.parametrize("ending", [".ot", ".bt"])
@pytest.mark.parametrize("size", [10**12, 10**30, -1, "many", "1e12", ""])
def test_a_claim_of_many_nodes_takes_no_memory(ending, size, tmp_path):
    tracemalloc.start()
    refused(tmp_path / f"huge{ending}", by_hand(ending, b"\0" * 100, size), "claims|size")
    _, most = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    assert most < 1e6


@pytest.mark.parametrize("ending", [".ot", ".bt"])
def test_a_file_larger_than_memory_is_not_read(ending, tmp_path, monkeypatch):
    monkeypatch.setattr("backhoe.perception.octree.tree.LARGEST", 10)
    data = b"\0" * 1000
    size = 200 if ending == ".ot" else 3000
    refused(tmp_path / f"large{ending}", by_hand(ending, data, size), "more than the")


@pytest.mark.parametrize(
    "name, content, words",
    [
        (
            "a.ot",
            by_hand(".ot", b"", 0, kind="ColorOcTree"),
            "must hold an OcTree, got 'ColorOcTree'",
        ),
        ("a.ot", by_hand(".bt", b"", 0), "must begin with '# Octomap OcTree file'"),
        ("a.bt", by_hand(".ot", b"", 0), "must begin with '# Octomap OcTree binary file'"),
        ("a.ot", b"\x89PNG\r\n" + bytes(500), "must begin"),
        ("a.ot", by_hand(".ot", b"", 0, res=0), "resolution above 0"),
        ("a.ot", by_hand(".ot", b"", 0, res="nan"), "resolution above 0"),
        ("a.ot", by_hand(".ot", b"", 0, res="wide"), "res must be a number"),
        ("a.ot", HEAD[".ot"] + b"# no end\n" * 9999, "must have a line 'data'"),
        ("a.ot", by_hand(".ot", b"\0\0\xc0\x7f\0", 1), "not finite"),
        ("a.ot", by_hand(".ot", b"\0\0\0\0\1" * 18, 18), "more than 16 levels"),
        ("a.ot", by_hand(".ot", b"\0\0\0\0\3" * 2, 2), "ends before its last node"),
        ("a.ot", by_hand(".ot", b"\0\0\0\0\0" * 2, 2), "goes on after its last node"),
        ("a.bt", by_hand(".bt", b"\3\0" * 17, 18), "more than 16 levels"),
        ("a.bt", by_hand(".bt", b"\0\0", 1), "inner node without children"),
        ("a.bt", by_hand(".bt", b"\1\0", 5), "claims 5 nodes and has 2"),
        ("a.bt", by_hand(".bt", b"\1\0\1", 2), "half a node"),
        ("a.pcd", b"", "ending must be one of .bt, .ot"),
    ],
)
def test_what_is_no_octree_is_refused_by_name(name, content, words, tmp_path):
    refused(tmp_path / name, content, words)


def test_a_map_that_is_one_leaf_has_no_bt(tmp_path):
    (tmp_path / "one.ot").write_bytes(by_hand(".ot", b"\0\0\x80\x3f\0", 1))
    tree = OccupancyOctree.load(tmp_path / "one.ot")
    assert tree.size == 1 and tree.log_odds([5, 5, 5]) == 1.0
    with pytest.raises(ValueError, match=r"save it as \.ot"):
        tree.save(tmp_path / "one.bt")
