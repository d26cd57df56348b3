"""What is stored in the lessons' notebooks, and that running them strictly notices a change.

pytest itself runs every notebook with nbval and compares what it prints (see pyproject.toml).
"""

import itertools
import re
import subprocess
import sys
from importlib import import_module
from pathlib import Path

import nbformat
import pytest

ROOT = Path(__file__).resolve().parents[1]
PATHS = sorted((ROOT / "notebooks").glob("*.ipynb"))
WIDGET = "application/vnd.jupyter.widget-view+json"
MACHINE_PATH = re.compile(r"(?<![\w.])/(?:work|tmp|home|root|Users|usr|var|opt)/|[A-Z]:\\\\?Users")
ADDRESS = re.compile(r"\bat 0x[0-9a-f]{6,}")


@pytest.fixture(params=PATHS, ids=lambda path: path.stem)
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
    assert [path.name for path in PATHS][:3] == [
        "00_tour.ipynb",
        "01_kinematics.ipynb",
        "02_dynamics.ipynb",
    ]


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
from IPython.display import display
print("volume 2.34 m3")
display({"text/html": '<iframe title="dig" srcdoc="123"></iframe>', "text/plain": "dig"}, raw=True)
display({"image/png": "aGVsbG8=", "text/plain": "a curve"}, raw=True)
"""


def _stored(volume="2.34", title="dig", page="123", png="aGVsbG8=", alt="a curve"):
    """TRIAL as a cell with these values in its stored outputs; the defaults are what it shows."""
    html = f'<iframe title="{title}" srcdoc="{page}"></iframe>'
    shown = [{"text/html": html, "text/plain": "dig"}, {"image/png": png, "text/plain": alt}]
    cell = nbformat.v4.new_code_cell(TRIAL, execution_count=1)
    cell.outputs = [
        nbformat.v4.new_output("stream", name="stdout", text=f"volume {volume} m3\n"),
        *(nbformat.v4.new_output("display_data", data=data) for data in shown),
    ]
    return cell


def test_nbval_notices_changed_text_and_passes_over_a_picture_and_a_recording(tmp_path):
    cells = {
        "as shown": (_stored(), "PASSED"),
        "other number": (_stored(volume="2.35"), "FAILED"),
        "other title": (_stored(title="dump"), "FAILED"),
        "other text alternative": (_stored(alt="a line"), "FAILED"),
        "other recording": (_stored(page="124"), "PASSED"),
        "other picture": (_stored(png="d29ybGQ="), "PASSED"),
    }
    path = tmp_path / "trial.ipynb"
    nbformat.write(nbformat.v4.new_notebook(cells=[cell for cell, _ in cells.values()]), path)
    command = [sys.executable, "-m", "pytest", "-c", str(ROOT / "pyproject.toml"), "-n0", "-rA"]
    command += ["--rootdir", str(tmp_path), "-p", "no:cacheprovider", str(path)]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=False)
    results = {int(n): r for r, n in re.findall(r"^(PASSED|FAILED) .*Cell (\d)", done.stdout, re.M)}
    found = {name: results.get(number) for number, name in enumerate(cells)}
    assert found == {name: expected for name, (_, expected) in cells.items()}, done.stdout


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
