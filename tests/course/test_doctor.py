"""`backhoe doctor` finds what is missing and names the fix."""

import subprocess
import sys
from collections import namedtuple
from importlib import metadata
from types import SimpleNamespace

import pytest

from backhoe.course import doctor, workspace

REQUIREMENTS = (workspace.root() / "requirements.txt").read_text(encoding="utf-8")
Version = namedtuple("Version", "major minor micro releaselevel serial")


@pytest.fixture
def machine(monkeypatch):
    """Makes the doctor believe in another system: `machine("win32", "AMD64", (3, 12))`."""

    def believe(system, processor, version):
        monkeypatch.setattr(doctor.sys, "platform", system)
        monkeypatch.setattr(doctor.sys, "version_info", Version(*version, 0, "final", 0))
        monkeypatch.setattr(doctor.platform, "machine", lambda: processor)

    return believe


@pytest.fixture
def packages(monkeypatch):
    """Makes the doctor see these packages; `package=None` hides one that is there."""
    real = metadata.version

    def see(**versions):
        def version(name):
            found = versions.get(name.replace("-", "_"), "real")
            if found is None:
                raise metadata.PackageNotFoundError(name)
            return real(name) if found == "real" else found

        monkeypatch.setattr(doctor.metadata, "version", version)

    return see


@pytest.fixture
def trials(monkeypatch):
    """Lets every trial in another interpreter end as told, without running it."""

    def end(returncode=0, stderr="", error=None):
        def run(*_, **__):
            if error:
                raise error
            return SimpleNamespace(returncode=returncode, stderr=stderr)

        monkeypatch.setattr(doctor.subprocess, "run", run)

    end()
    return end


def _wrong(findings):
    return {finding.name: finding for finding in findings if finding.well is False}


def test_all_is_well_where_the_tests_run(capsys):
    findings = doctor.examine()
    assert _wrong(findings) == {}
    assert doctor.report(findings) == 0
    assert capsys.readouterr().out.endswith("All is well.\n")


def test_missing_package_is_named_with_its_fix(packages, trials, capsys):
    packages(scipy=None)
    findings = doctor.examine()
    assert list(_wrong(findings)) == ["scipy"]
    assert _wrong(findings)["scipy"].fix.endswith("-m pip install scipy==1.17.1")
    assert doctor.report(findings) == 1
    out = capsys.readouterr().out
    assert "WRONG  scipy: is missing" in out
    assert sys.executable in out


def test_other_version_is_named_with_the_wanted_one(packages, trials):
    packages(matplotlib="2.0.0")
    finding = _wrong(doctor.examine())["matplotlib"]
    assert finding.detail == "is 2.0.0, wanted 3.11.2"
    assert finding.fix.endswith("-m pip install matplotlib==3.11.2")


def test_conda_may_have_another_last_number(packages, trials, monkeypatch, tmp_path):
    (tmp_path / "conda-meta").mkdir()
    monkeypatch.setattr(doctor.sys, "prefix", str(tmp_path))
    packages(matplotlib="3.11.9", scipy="1.16.1")
    assert list(_wrong(doctor.examine())) == ["scipy"]


@pytest.mark.parametrize("version", [(3, 10), (3, 14)])
def test_unsupported_interpreter_is_wrong(machine, trials, version):
    machine("linux", "x86_64", version)
    assert "install Python 3.11" in _wrong(doctor.examine())["interpreter"].fix


def test_missing_pybullet_is_wrong_where_it_is_built(machine, packages, trials):
    packages(pybullet=None, pybullet_arm64=None)
    machine("linux", "x86_64", (3, 11))
    assert _wrong(doctor.examine())["PyBullet"].fix.endswith("install pybullet==3.2.7")
    machine("win32", "AMD64", (3, 12))
    assert _wrong(doctor.examine())["PyBullet"].fix.endswith("install pybullet_arm64==3.2.8")


def test_missing_pybullet_is_no_fault_where_it_is_not_built(machine, packages, trials):
    packages(pybullet=None, pybullet_arm64=None)
    machine("linux", "aarch64", (3, 12))
    findings = doctor.examine()
    assert _wrong(findings) == {}
    assert "analytic" in next(f for f in findings if f.name == "PyBullet").detail


def test_two_pybullets_are_wrong(packages, trials):
    packages(pybullet="3.2.7", pybullet_arm64="3.2.8")
    fix = _wrong(doctor.examine())["PyBullet"].fix
    assert "uninstall -y pybullet pybullet_arm64 && " in fix


def test_broken_pybullet_kernel_and_numba_are_each_found(packages, trials):
    trials(returncode=1, stderr="Traceback\nImportError: DLL load failed")
    wrong = _wrong(doctor.examine())
    assert list(wrong) == ["PyBullet renders without a screen", "numba compiles", "Jupyter kernel"]
    for finding in wrong.values():
        assert finding.detail == "ImportError: DLL load failed"
        assert "--force-reinstall" in finding.fix


def test_crash_without_a_word_is_found(trials):
    trials(returncode=-11)
    assert "stopped with code -11" in _wrong(doctor.examine())["numba compiles"].detail


def test_kernel_that_never_answers_is_found(trials):
    trials(error=subprocess.TimeoutExpired("python", 180))
    assert "no answer" in _wrong(doctor.examine())["Jupyter kernel"].detail


def test_missing_browser_is_only_a_note(trials, monkeypatch):
    monkeypatch.setattr(doctor.shutil, "which", lambda name: None)
    findings = doctor.examine()
    assert _wrong(findings) == {}
    assert "no Chromium" in findings[-1].detail


def test_course_without_its_folder_is_found(trials, monkeypatch, tmp_path):
    monkeypatch.setattr(workspace, "__file__", str(tmp_path / "a" / "b" / "workspace.py"))
    assert "no notebooks" in _wrong(doctor.examine())["course"].detail


@pytest.mark.parametrize(
    ("system", "processor", "version", "expected"),
    [
        ("linux", "x86_64", (3, 11), ["pybullet==3.2.7"]),
        ("linux", "x86_64", (3, 12), ["pybullet_arm64==3.2.8"]),
        ("linux", "aarch64", (3, 11), []),
        ("win32", "AMD64", (3, 11), ["pybullet_arm64==3.2.8"]),
        ("win32", "ARM64", (3, 12), []),
        ("darwin", "arm64", (3, 13), ["pybullet_arm64==3.2.8"]),
        ("darwin", "x86_64", (3, 12), ["pybullet_arm64==3.2.8"]),
        ("darwin", "x86_64", (3, 13), []),
    ],
)
def test_each_system_gets_at_most_one_pybullet_and_one_of_each_other(
    machine, system, processor, version, expected
):
    machine(system, processor, version)
    found = doctor.pins(REQUIREMENTS)
    names = [pin.name for pin in found]
    assert [f"{p.name}=={p.version}" for p in found if "bullet" in p.name] == expected
    assert len(names) == len(set(names))
    assert {"numpy", "numba", "scipy", "jupyterlab"} <= set(names)


def test_markers_agree_with_the_packaging_library(machine):
    from packaging.requirements import Requirement

    lines = [line.split("#")[0].strip() for line in REQUIREMENTS.splitlines()]
    parsed = [Requirement(line) for line in lines if line and not line.startswith("-")]
    for system, processor in [("linux", "x86_64"), ("darwin", "arm64"), ("win32", "AMD64")]:
        for minor in (11, 12, 13):
            machine(system, processor, (3, minor))
            here = {
                "sys_platform": system,
                "platform_machine": processor,
                "python_version": f"3.{minor}",
            }
            wanted = [r.name for r in parsed if r.marker is None or r.marker.evaluate(here)]
            assert [pin.name for pin in doctor.pins(REQUIREMENTS)] == wanted


@pytest.mark.parametrize("line", ["numpy>=2", "numpy", 'numpy==2.0 ; os_name == "nt"'])
def test_line_that_is_no_pin_is_refused(line):
    with pytest.raises(ValueError, match=r"requirements\.txt|marker not understood"):
        doctor.pins(line)


def test_doctor_needs_nothing_but_the_standard_library():
    code = (
        "import sys; sys.path.insert(0, sys.argv[1]); from backhoe.course import doctor; "
        "sys.exit(doctor.report(doctor.examine()))"
    )
    lib = str(workspace.root() / "lib")
    bare = [sys.executable, "-I", "-S", "-c", code, lib]
    done = subprocess.run(bare, capture_output=True, text=True, check=False)
    assert done.returncode == 1
    assert done.stderr == ""
    assert "WRONG  numpy: is missing" in done.stdout
