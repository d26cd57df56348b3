"""What nbval leaves out when it compares a notebook's cell with a new run: pictures, recordings.

A pytest plugin (pyproject.toml loads it) with the comparison that `.ci/refresh` uses too. nbval
compares the texts, those around a replay included; here

- a picture must have the size of the stored one, and all but a few of its pixels must look alike;
- a replay's page must be the same, and each quantised value of its recording within one step.
"""

from __future__ import annotations

import gzip
import re
import zlib
from base64 import b64decode
from html import unescape
from io import BytesIO
from pathlib import Path

import numpy as np
import pytest

VISIBLE = 0.04
"""Difference of a colour's part, 0 to 1, from which on a pixel counts as another one."""
SHARE = 1e-3
"""Share of the pixels that may be another one: two processors round a curve's edge differently."""
SPOT = 0.02
"""Mean difference that a tile may have: one marker or one digit is no share, but fills a tile."""
_TILE = 16  # pixels
_PICTURE, _PAGE = "image/png", "text/html"
_PAGES = re.compile(r'srcdoc="([^"]*)"')
_UNREADABLE = OSError, EOFError, TypeError, ValueError, SyntaxError, zlib.error


def pytest_configure(config):
    """What nbval leaves out is said beside this file, wherever pytest was started."""
    config.option.nbval_sanitize_with = str(Path(__file__).with_suffix(".cfg"))


@pytest.hookimpl(wrapper=True)
def pytest_runtest_call(item):
    """After nbval has run a cell and compared its texts, compare the rest."""
    result = yield
    if hasattr(item, "test_outputs") and item.test_outputs is not None:
        stored, new = map(_shown, (item.cell.outputs, item.test_outputs))
        if faults := differences(stored, new):
            item.raise_cell_error("Pictures or replays differ from those stored", "\n".join(faults))
    return result


def differences(stored: list, new: list) -> list[str]:
    """What differs between two lists of outputs' `data`, a line each; texts are not looked at."""
    if [_kinds(data) for data in stored] != [_kinds(data) for data in new]:
        return [f"stored are {_listed(stored)}, new are {_listed(new)}"]
    faults = []
    for number, (one, other) in enumerate(zip(stored, new, strict=True), start=1):
        for kind, compare in ((_PICTURE, picture_difference), (_PAGE, page_difference)):
            if kind in one and (fault := compare(one[kind], other[kind])):
                faults.append(f"output {number}: {fault}")
    return faults


def keep(stored: list, new: list) -> None:
    """Put stored pictures and replays in the place of new ones that do not differ from them."""
    for one, other in zip(*map(_shown, (stored, new)), strict=False):
        if _kinds(one) == _kinds(other) and not differences([one], [other]):
            around = [_PAGES.sub("", data.get(_PAGE, "")) for data in (one, other)]
            kinds = (_PICTURE, _PAGE) if around[0] == around[1] else (_PICTURE,)
            other.update({kind: one[kind] for kind in kinds if kind in one})


def picture_difference(stored: str, new: str) -> str:
    """How two PNG files in base64 differ to the eye; empty if they do not."""
    if stored.strip() == new.strip():
        return ""
    try:
        one, other = (_pixels(text) for text in (stored, new))
    except _UNREADABLE as error:
        return f"a picture cannot be read: {error}"
    if one.shape != other.shape:
        return "the picture was {1} x {0} pixels, now {3} x {2}".format(
            *one.shape[:2], *other.shape[:2]
        )
    change = np.abs(one - other).max(axis=-1)
    changed = change > VISIBLE
    if changed.sum() <= SHARE * changed.size and _tiles(change).max() <= SPOT:
        return ""
    rows, columns = np.nonzero(change > min(VISIBLE, change.max() / 2))
    return (
        f"{changed.sum()} of {changed.size} pixels of the picture ({changed.mean():.2%}) look "
        f"different, in columns {columns.min()} to {columns.max()}, rows {rows.min()} to "
        f"{rows.max()}"
    )


def page_difference(stored: str, new: str) -> str:
    """How the replays in two pieces of HTML differ; empty if by a step of a value at most."""
    if stored == new:
        return ""
    pages, others = _pages(stored), _pages(new)
    if len(pages) != len(others):
        return f"{len(pages)} replays are stored, {len(others)} are new"
    for page, other in zip(pages, others, strict=True):
        if page == other:
            continue
        try:
            text, code, recording = _parts(page)
            new_text, new_code, new_recording = _parts(other)
        except _UNREADABLE as error:
            return f"a replay cannot be read: {error}"
        if text != new_text:
            return "the page of the replay is another one"
        if code != new_code:
            return "the player of the replay is another one"
        if fault := recording_difference(recording, new_recording):
            return f"the recording of the replay differs in {fault}"
    return ""


def recording_difference(stored: bytes | None, new: bytes | None) -> str:
    """The first part in which two recordings differ by more than a step; empty if in none."""
    from backhoe.view.replay.recording_file import decode

    if stored == new:
        return ""
    try:
        one, other = (_whole_steps(decode(data)) for data in (stored, new))
    except _UNREADABLE as error:
        return f"what cannot be read: {error}"
    return _first_difference(one, other, "")


def _first_difference(one: object, other: object, place: str) -> str:
    if isinstance(one, np.ndarray) and isinstance(other, np.ndarray):
        if one.shape != other.shape:
            return f"{place}: shape {one.shape}, now {other.shape}"
        steps = np.abs(one - other).max(initial=0.0)
        return f"{place}: by {steps:.0f} steps" if steps > 1.5 else ""
    if isinstance(one, dict) and isinstance(other, dict) and one.keys() == other.keys():
        pairs = [(one[key], other[key], f"{place} {key}".strip()) for key in one]
    elif isinstance(one, list) and isinstance(other, list) and len(one) == len(other):
        pairs = [(a, b, f"{place} {k}") for k, (a, b) in enumerate(zip(one, other, strict=True))]
    else:
        return "" if type(one) is type(other) and one == other else f"{place}: {one}, now {other}"
    return next((fault for pair in pairs if (fault := _first_difference(*pair))), "")


def _whole_steps(decoded: dict) -> dict:
    """A decoded recording with its values counted in their steps."""
    from backhoe.view.replay.recording_file import ANGLE_STEP, LENGTH_STEP, SCALAR_STEP, TIME_STEP

    steps = {
        "revolute": ANGLE_STEP,
        "planar": [LENGTH_STEP] * 2 + [ANGLE_STEP],
        "free": [LENGTH_STEP] * 3 + [ANGLE_STEP] * 4,
    }
    decoded["times"] = decoded["times"] / TIME_STEP
    for entry in decoded["scalars"]:
        entry["values"] = entry["values"] / SCALAR_STEP
    for line in decoded["lines"]:
        line["points"] = line["points"] / LENGTH_STEP
    for node in decoded["nodes"]:
        if "values" in node:
            node["values"] = node["values"] / steps[node["motion"]]
        for mesh in node["meshes"]:
            mesh["vertices"] = mesh["vertices"] / LENGTH_STEP
    for field in decoded["fields"]:
        field["heights"] = np.array(field["heights"]) / field["step"]
    return decoded


def _shown(outputs: list) -> list:
    return [output["data"] for output in outputs if "data" in output]


def _kinds(data: dict) -> list[str]:
    return [kind for kind in (_PICTURE, _PAGE) if kind in data]


def _listed(outputs: list) -> str:
    kinds = [kind for data in outputs for kind in _kinds(data)]
    return f"{kinds.count(_PICTURE)} pictures and {kinds.count(_PAGE)} pages"


def _pixels(text: str) -> np.ndarray:
    from matplotlib.image import imread

    return imread(BytesIO(b64decode(text)), format="png")


def _tiles(change: np.ndarray) -> np.ndarray:
    """Mean of the change in each tile of the picture."""
    rows, columns = (-(-size // _TILE) for size in change.shape)
    whole = np.zeros((rows * _TILE, columns * _TILE))
    whole[: change.shape[0], : change.shape[1]] = change
    return whole.reshape(rows, _TILE, columns, _TILE).mean(axis=(1, 3))


def _pages(html: str) -> list[str]:
    return [unescape(page) for page in _PAGES.findall(html)]


def _parts(page: str) -> tuple[str, bytes | None, bytes | None]:
    """The page without what is packed in it, the player and the recording."""
    packed: dict[str, bytes] = {}

    def take(match: re.Match) -> str:
        packed[match[2]] = b64decode(match[3])
        return match[1]

    text = re.sub(r'(<script type="text/plain" id="(player|recording)">)([^<]*)', take, page)
    code = packed.get("player")
    return text, code and gzip.decompress(code), packed.get("recording")
