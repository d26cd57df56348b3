"""The course's folder: what is committed, what the README promises, what an import loads."""

import re
import subprocess
import sys
from pathlib import Path

import pytest
import yaml

ROOT = Path(__file__).resolve().parents[1]
README = (ROOT / "README.md").read_text(encoding="utf-8")
HEAVY_BY_NATURE = re.compile(
    r"backhoe\.(view\.plots(\..*)?|simulation\.\w+|lessons\.\w+\.(figures(\.\w+)?|bench)|.*kernels|.*compiled|.*engine)"
)
HEAVY = ("scipy", "matplotlib", "pybullet", "numba", "IPython", "ipywidgets", "control", "sympy")


def _committed(*patterns):
    listed = subprocess.run(
        ["git", "ls-files", "-z", *patterns], cwd=ROOT, capture_output=True, text=True, check=False
    )
    if listed.returncode:
        pytest.skip("this copy of the course has no git repository to list its files")
    return [name for name in listed.stdout.split("\0") if name and (ROOT / name).is_file()]


def _text(name):
    return (ROOT / name).read_text(encoding="utf-8")


def _module_names():
    package = ROOT / "lib" / "backhoe"
    for path in sorted(package.rglob("*.py")):
        parts = path.relative_to(package.parent).with_suffix("").parts
        yield ".".join(parts[:-1] if parts[-1] == "__init__" else parts)


def test_import_of_any_part_loads_nothing_heavy():
    """Plots, worlds and compiled loops load what they need when they are used."""
    light = [name for name in _module_names() if not HEAVY_BY_NATURE.fullmatch(name)]
    assert len(light) > 10
    code = f"""
import importlib, sys
for name in {light!r}:
    importlib.import_module(name)
    heavy = sorted(set({HEAVY!r}) & set(sys.modules))
    if heavy:
        sys.exit(f"{{name}} loads {{heavy}}")
"""
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr


@pytest.mark.parametrize("name", ["README.md", "CONTRIBUTING.md", "data/README.md"])
def test_links_between_files_lead_somewhere(name):
    links = re.findall(r"\]\(([^)#]+)\)", _text(name))
    broken = [
        link
        for link in links
        if not link.startswith("http") and not (ROOT / name).parent.joinpath(link).exists()
    ]
    assert broken == []


def test_readme_gives_two_commands_that_ci_runs_word_for_word():
    lines = README.splitlines()
    start = [line for line in lines if line.endswith("&& .venv/bin/backhoe lab")]
    tests = [line for line in lines if line.endswith("&& .venv/bin/pytest")]
    assert len(start) == len(tests) == 1
    script = _text(".ci/run")
    assert "grep -m1 '&& .venv/bin/backhoe lab$' README.md" in script
    assert "grep -m1 '&& .venv/bin/pytest$' README.md" in script
    for line in start + tests:
        (requirements,) = re.findall(r"-r (\S+)", line)
        assert (ROOT / requirements).is_file()
        windows = line.replace("python3", "py").replace(".venv/bin/", ".venv\\Scripts\\")
        assert windows.replace(" && ", "; ") in lines


def test_readme_lists_every_lesson():
    for path in sorted((ROOT / "notebooks").rglob("[0-9]*.ipynb")):
        assert f"({path.relative_to(ROOT).as_posix()})" in README


@pytest.mark.parametrize("name", ["requirements.txt", "requirements-dev.txt"])
def test_every_requirement_is_pinned_and_has_its_reason(name):
    reason = None
    for line in _text(name).splitlines():
        if not line.strip():
            reason = None
        elif line.startswith("#"):
            reason = line
        elif not line.startswith("-"):
            assert re.match(r"[\w.-]+==[\w.]+(\s|$)", line), line
            assert "  # " in line or reason, line


def test_citation_and_library_have_the_same_version():
    import backhoe

    assert yaml.safe_load(_text("CITATION.cff"))["version"] == backhoe.__version__
    assert f'version = "{backhoe.__version__}"' in _text("lib/pyproject.toml")
    assert f"## {backhoe.__version__}" in _text("CHANGELOG.md")


def test_no_committed_text_names_a_place_on_somebodys_machine():
    place = re.compile(r"(?<![\w.$}/-])/(?:work|tmp|home|root|Users)/\w")
    binary = (".png", ".ipynb", ".js", ".npz")
    for name in _committed():
        if name.endswith(binary) or name == "tests/test_notebooks.py":
            continue
        found = place.search(_text(name))
        assert not found, f"{name}: {found[0]}"


def test_no_lock_file_names_a_registry():
    for name in _committed("*.lock", "*lock.json", "*requirements*.txt"):
        assert not re.search(
            r"https?://[^\s\"']*(registry|pypi|npmjs|mirror|index)", _text(name)
        ), name
