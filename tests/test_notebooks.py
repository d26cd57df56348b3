"""What is stored in the lessons' notebooks, and that running them strictly notices a change.

pytest itself runs every notebook with nbval and compares what it prints (see pyproject.toml).
"""

import gzip
import itertools
import re
import subprocess
import sys
from base64 import b64decode, b64encode
from importlib import import_module
from io import BytesIO
from pathlib import Path

import nbformat
import numpy as np
import pytest

import notebook_outputs
from backhoe.view.plots import style
from backhoe.view.plots.told import told
from backhoe.view.replay.recording import HEIGHT_STEP, HeightField, Recording
from backhoe.view.replay.recording_file import encode

ROOT = Path(__file__).resolve().parents[1]
PATHS = sorted((ROOT / "notebooks").rglob("[0-9]*.ipynb"))
WIDGET = "application/vnd.jupyter.widget-view+json"
MACHINE_PATH = re.compile(r"(?<![\w.])/(?:work|tmp|home|root|Users|usr|var|opt)/|[A-Z]:\\\\?Users")
ADDRESS = re.compile(r"\bat 0x[0-9a-f]{6,}")


@pytest.fixture(params=PATHS, ids=lambda path: f"{path.parent.name} {path.stem}")
def path(request):
    return request.param


@pytest.fixture
def notebook(path):
    return nbformat.read(path, as_version=4)


@pytest.fixture
def code(notebook):
    return [cell for cell in notebook.cells if cell.cell_type == "code"]


@pytest.fixture
def outputs(code):
    return [output for cell in code for output in cell.outputs]


def test_there_are_lessons():
    assert [path.name for path in PATHS][:2] == ["00_tour.ipynb", "01a_frames.ipynb"]


def test_notebook_is_valid(notebook):
    nbformat.validate(notebook)


def test_every_cell_was_run_once_from_top_to_bottom(code):
    assert [cell.execution_count for cell in code] == list(range(1, len(code) + 1))


def test_no_output_is_an_error_or_a_warning(outputs):
    kinds = {output.get("name", output.output_type) for output in outputs}
    assert kinds <= {"stdout", "display_data", "execute_result"}


def test_no_cell_escapes_the_comparison(code):
    for cell in code:
        assert not set(cell.metadata.get("tags", ())) & {"nbval-skip", "nbval-ignore-output"}
        assert not re.search(r"#\s*(NBVAL_(SKIP|IGNORE)|PYTEST_VALIDATE_IGNORE)", cell.source)


def test_every_picture_has_a_text_alternative(outputs):
    pictures = [o for o in outputs if any(k.startswith("image/") for k in o.get("data", ()))]
    for picture in pictures:
        text = picture.data["text/plain"]
        assert len(text.split()) >= 4, text
        assert not re.match(r"<.*>$|Figure\(", text), text


def test_every_frame_has_a_title(outputs):
    for output in outputs:
        for frame in re.findall(r"<iframe[^>]*", output.get("data", {}).get("text/html", "")):
            assert re.search(r'title="[^"]{10,}"', frame)


def test_nothing_stored_depends_on_the_machine(notebook, outputs):
    texts = [cell.source for cell in notebook.cells]
    for output in outputs:
        texts += [output.get("text", ""), *map(str, output.get("data", {}).values())]
    for text in texts:
        readable = re.sub(r"[A-Za-z0-9+/]{200,}=*", "", text)  # recordings and pictures
        assert not MACHINE_PATH.search(readable), MACHINE_PATH.search(readable)
        assert not ADDRESS.search(readable), ADDRESS.search(readable)


def test_metadata_is_in_the_normal_form(notebook, outputs):
    """`.ci/refresh --tidy` brings a notebook into it."""
    assert notebook.metadata == {
        "kernelspec": {
            "display_name": "Python 3 (ipykernel)",
            "language": "python",
            "name": "python3",
        },
        "language_info": {"name": "python"},
    }
    for cell in notebook.cells:
        assert set(cell.metadata) <= {"tags"}
    assert not any(WIDGET in output.get("data", {}) for output in outputs)
    for cell in notebook.cells:
        names = [output.get("name") for output in cell.get("outputs", ())]
        assert not any(one == other is not None for one, other in itertools.pairwise(names))


def test_no_formula_has_lost_a_backslash(notebook):
    r"""\frac, \text, \varepsilon, \right written without r"..." become control characters; of \r
    a line is left that begins with the rest of its name."""
    for cell in notebook.cells:
        assert not re.search(r"[\x00-\x09\x0b-\x1f]", cell.source), cell.source
        if cell.cell_type == "markdown":
            assert not re.search(r"^(Vert|vert|ight|ho|mathrm)\b", cell.source, re.MULTILINE)


def test_notebook_is_small_enough_to_load_quickly(path):
    assert path.stat().st_size <= 1.5e6


def test_notebook_opens_with_its_title(notebook):
    assert notebook.cells[0].cell_type == "markdown"
    assert re.match(r"# \S", notebook.cells[0].source)
    titles = [
        line
        for cell in notebook.cells
        if cell.cell_type == "markdown"
        for line in cell.source.splitlines()
        if re.match(r"# \S", line)
    ]
    assert len(titles) == 1


TRIAL = """
import numpy as np
from backhoe.view import plots, replay

def waves(shift=0.0, colour=plots.COLOURS[0], height=1.5):
    fig, ax = plots.figure(2.5, height)
    ax.plot(np.linspace(0, 1, 50) + shift, np.sin(np.linspace(0, 6, 50)), color=colour)
    return fig

def bars(there=True):
    fig, ax = plots.figure(2.5, 1.5)
    ax.bar([1, 2, 3], [2, 1, 4]) if there else ax.axis("off")
    return fig

def digs(steps=0, frames=20, title="dig"):
    q = np.outer(np.linspace(0, 1, 20), [0.1, 0.2, -0.3, 0.4])[:frames]
    q[len(q) // 2, 2] += 1e-4 * steps
    return replay.from_joints(np.arange(len(q)) / 20, q, title=title, alt="The arm digs.")

"""
CELL = """
print("volume 2.34 m3")
plots.show(waves(), "a curve that waves")
plots.show(bars(), "three bars beside it")
digs()
"""


def _stored(draw, volume="2.34", alt="a curve that waves", pictures=None, page=str, **shown):
    """CELL with its outputs as they are, but for what is said."""
    if "pictures" not in draw:
        draw["pictures"] = [style.png(draw[name]()) for name in ("waves", "bars")]
    pictures = [*(pictures or ()), *draw["pictures"][len(pictures or ()) :]]
    texts = alt, "three bars beside it"
    texts = (
        f"{text}\n{told(draw[name]())}" for text, name in zip(texts, ("waves", "bars"), strict=True)
    )
    data = [{"image/png": p, "text/plain": t} for p, t in zip(pictures, texts, strict=True)]
    replay = draw["digs"](**shown)
    html = {"text/html": page(replay._repr_html_()), "text/plain": repr(replay)}
    data = [
        {k: b64encode(v).decode() if isinstance(v, bytes) else v for k, v in one.items() if v}
        for one in (*data, html)
    ]
    cell = nbformat.v4.new_code_cell(CELL, execution_count=1)
    cell.outputs = [
        nbformat.v4.new_output("stream", name="stdout", text=f"volume {volume} m3\n"),
        *(nbformat.v4.new_output("display_data", data=one) for one in data),
    ]
    return cell


def _recording(replace):
    """Function of a replay's HTML that puts other bytes in the place of its recording."""

    def replaced(html):
        found = re.search(r"(id=&quot;recording&quot;&gt;)([^&]*)", html)
        other = b64encode(replace(b64decode(found[2]))).decode()
        return html.replace(found[2], other)

    return replaced


def test_nbval_notices_changed_texts_pictures_and_recordings(tmp_path):
    draw = {}
    exec(TRIAL, draw)
    wave, bar = style.png(draw["waves"]()), style.png(draw["bars"]())
    same = BytesIO()
    draw["waves"]().savefig(same, format="png", dpi=style.SHARP, metadata={"Software": "another"})

    def with_outputs(**changes):
        return _stored(draw, **changes)

    def first(**changes):
        return with_outputs(pictures=[style.png(draw["waves"](**changes))])

    cells = {
        "the functions": (nbformat.v4.new_code_cell(TRIAL, execution_count=1), "PASSED"),
        "as shown": (with_outputs(), "PASSED"),
        "another number": (with_outputs(volume="2.35"), "FAILED"),
        "another text alternative": (with_outputs(alt="a line"), "FAILED"),
        "another file of the same picture": (with_outputs(pictures=[same.getvalue()]), "PASSED"),
        "blank": (with_outputs(pictures=[wave, style.png(draw["bars"](there=False))]), "FAILED"),
        "swapped": (with_outputs(pictures=[bar, wave]), "FAILED"),
        "one removed": (with_outputs(pictures=[wave, None]), "FAILED"),
        "broken": (with_outputs(pictures=[wave[:200]]), "FAILED"),
        "moved by half a per cent": (first(shift=0.005), "FAILED"),
        "another colour": (first(colour=style.COLOURS[1]), "FAILED"),
        "another size": (first(height=1.6), "FAILED"),
        "another title": (with_outputs(title="dump"), "FAILED"),
        "one step": (with_outputs(steps=1), "PASSED"),
        "three steps": (with_outputs(steps=3), "FAILED"),
        "frames dropped": (with_outputs(frames=15), "FAILED"),
        "another compression": (
            with_outputs(page=_recording(lambda data: gzip.compress(gzip.decompress(data), 1))),
            "PASSED",
        ),
        "broken recording": (with_outputs(page=_recording(lambda data: data[:50])), "FAILED"),
        "another page": (
            with_outputs(page=lambda html: html.replace("WebGL 2", "WebGL 1")),
            "FAILED",
        ),
        "no replay": (with_outputs(page=lambda html: re.sub('srcdoc="[^"]*"', "", html)), "FAILED"),
    }
    path = tmp_path / "trial.ipynb"
    nbformat.write(nbformat.v4.new_notebook(cells=[cell for cell, _ in cells.values()]), path)
    command = [sys.executable, "-m", "pytest", "-c", str(ROOT / "pyproject.toml"), "-n1", "-rA"]
    command += ["--rootdir", str(tmp_path), "-p", "no:cacheprovider", str(path)]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=False)
    results = {
        int(n): r for r, n in re.findall(r"^(PASSED|FAILED) .*Cell (\d+)", done.stdout, re.M)
    }
    found = {name: results.get(number) for number, name in enumerate(cells)}
    assert found == {name: expected for name, (_, expected) in cells.items()}, done.stdout
    assert "output 1: the picture was 500 x 320 pixels, now 500 x 300" in done.stdout
    assert "nodes 3 values: by 3 steps" in done.stdout


def test_refresh_keeps_what_looks_the_same_and_takes_what_does_not():
    draw = {}
    exec(TRIAL, draw)
    again = _recording(lambda data: gzip.compress(gzip.decompress(data), 1))
    for changes, kept in (
        ({"page": again}, [True, True, True]),
        ({"steps": 1}, [True, True, True]),
        ({"title": "dump"}, [True, True, False]),
        ({"pictures": [style.png(draw["waves"](shift=0.005))]}, [False, True, True]),
    ):
        stored, new = _stored(draw).outputs, _stored(draw, **changes).outputs
        notebook_outputs.keep(stored, new)
        kinds = ("image/png", "image/png", "text/html")
        pairs = zip(stored[1:], new[1:], kinds, strict=True)
        assert [one.data[kind] == other.data[kind] for one, other, kind in pairs] == kept, changes


def test_heights_of_soil_are_compared_in_their_steps():
    def recording(steps, cell):
        field = HeightField("ground", np.zeros((3, 4)), 0.1, (0.0, 0.0))
        heights = np.zeros((3, 4))
        heights[1, cell] = HEIGHT_STEP * steps
        field.append(heights)
        return encode(Recording(times=[0.0, 0.1], nodes=(), fields=(field,)))

    assert not notebook_outputs.recording_difference(recording(5, 2), recording(6, 2))
    assert "fields 0 heights" in notebook_outputs.recording_difference(
        recording(5, 2), recording(7, 2)
    )
    assert notebook_outputs.recording_difference(recording(5, 2), recording(5, 1))


def _named_in_prose(notebook):
    """Names of the library in backticks, such as `odometry.integrate` or `backhoe.machine`."""
    imports = "\n".join(
        line
        for cell in notebook.cells
        if cell.cell_type == "code"
        for line in cell.source.splitlines()
        if line.startswith(("from backhoe", "import backhoe"))
    )
    known = {"backhoe": import_module("backhoe")}
    exec(imports, known)
    for cell in notebook.cells:
        if cell.cell_type == "markdown":
            for name in re.findall(r"`([a-z_]\w*(?:\.[A-Za-z_]\w*)+)", cell.source):
                if name.split(".")[0] in known:
                    yield name, known


def test_every_name_of_the_library_that_a_lesson_mentions_is_there(notebook):
    for name, known in _named_in_prose(notebook):
        first, *rest = name.split(".")
        thing = known[first]
        for part in rest:
            if not hasattr(thing, part) and hasattr(thing, "__path__"):
                import_module(f"{thing.__name__}.{part}")
            assert hasattr(thing, part), f"`{name}` is not in the library"
            thing = getattr(thing, part)
