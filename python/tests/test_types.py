"""The type checker and the documents."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

import pantoline
from conftest import TREE


def block(page: Path, mark: str) -> str:
    """The first block of Python after a mark of a page."""
    text = page.read_text(encoding="utf-8")
    return text[text.index(mark) :].split("```python\n", 1)[1].split("```", 1)[0]


def test_the_type_checker_finds_nothing() -> None:
    root = Path(pantoline.__file__).parent.parent
    command = [sys.executable, "-m", "mypy", "--config-file", TREE / "python" / "pyproject.toml", "--cache-dir", os.devnull]
    found = subprocess.run(command, cwd=root, capture_output=True, text=True)
    assert found.returncode == 0, found.stdout + found.stderr


@pytest.fixture(scope="module")
def place(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Folder in which the lines of all documents run, one after the other."""
    place = tmp_path_factory.mktemp("documents")
    for folder in ("scenes", "examples"):
        (place / folder).symlink_to(TREE / folder)
    return place


def test_the_lines_of_the_readme_run_as_printed(place: Path) -> None:
    lines = block(TREE / "README.md", "## In Python and Rust")
    assert len(lines.splitlines()) <= 10
    ended = subprocess.run([sys.executable, "-c", lines], cwd=place, capture_output=True, text=True)
    assert ended.returncode == 0, ended.stderr
    assert float(ended.stdout.split()[0]) > 0


def test_the_lines_of_the_guide_run_as_printed(place: Path) -> None:
    page = TREE / "docs" / "guide" / "python.md"
    marks = ("## Scenes", "## Runs", "## Steps", "## Sweeps", "## Sensitivity", "`pantoline.Samples` has")
    script = "\n".join(["import matplotlib; matplotlib.use('agg')", *(block(page, mark) for mark in marks)])
    ended = subprocess.run([sys.executable, "-c", script], cwd=place, capture_output=True, text=True)
    assert ended.returncode == 0, ended.stderr


def test_the_package_carries_program_and_fmus() -> None:
    said = subprocess.run([pantoline.program(), "--version"], capture_output=True, text=True, check=True)
    assert pantoline.__version__ in said.stdout
