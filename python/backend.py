"""Build backend of the package: maturin, after the program and the FMUs that a wheel carries.

Program and libraries are built in the target folder of the workspace, so that a build that is there is used again.
"""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
from pathlib import Path
from typing import Any

import maturin
from maturin import get_requires_for_build_editable, get_requires_for_build_sdist, get_requires_for_build_wheel
from maturin import prepare_metadata_for_build_editable, prepare_metadata_for_build_wheel

__all__ = [
    "build_editable",
    "build_sdist",
    "build_wheel",
    "get_requires_for_build_editable",
    "get_requires_for_build_sdist",
    "get_requires_for_build_wheel",
    "prepare_metadata_for_build_editable",
    "prepare_metadata_for_build_wheel",
]

TREE = Path(__file__).resolve().parent.parent
PACKAGE = TREE / "python" / "pantoline"
#: Targets of which the wheel carries the files.
CARRIED = {"master", "catenary_fmu", "pantograph_fmu"}
#: Scene of the two FMUs that a wheel carries.
SCENE = TREE / "scenes" / "en50318-300.toml"


def _cargo(*arguments: str) -> str:
    command = [os.environ.get("CARGO", "cargo"), *arguments]
    try:
        return subprocess.run(command, cwd=TREE, check=True, stdout=subprocess.PIPE, text=True).stdout
    except FileNotFoundError:
        raise SystemExit("cargo is not there: install Rust with https://rustup.rs, then install again") from None


def _artifacts() -> list[Path]:
    """Files of the program and of the libraries of the FMUs, built where they are not up to date."""
    # One selection with the package itself: the features of the libraries are those of the whole workspace.
    packages = ["-p", "master", "-p", "fmu-catenary", "-p", "fmu-pantograph", "-p", "pantoline-python"]
    told = _cargo("build", "--release", "--locked", "--message-format=json-render-diagnostics", *packages)
    files = []
    for line in told.splitlines():
        message = json.loads(line)
        target = message.get("target", {})
        if message.get("reason") == "compiler-artifact" and target["name"] in CARRIED:
            files += [Path(file) for file in message["filenames"]]
    return files


def _carry() -> None:
    """Puts the program, its libraries and two FMUs into the package."""
    programs = PACKAGE / "bin"
    shutil.rmtree(programs, ignore_errors=True)
    programs.mkdir()
    for file in _artifacts():
        if file.suffix in {"", ".exe", ".so", ".dylib", ".dll"}:
            shutil.copy2(file, programs / file.name)
    program = programs / ("master.exe" if sys.platform == "win32" else "master")
    fmus = PACKAGE / "fmus"
    shutil.rmtree(fmus, ignore_errors=True)
    subprocess.run([program, "package", SCENE, "--out", fmus, "-q"], check=True)


def build_wheel(directory: str, settings: Any = None, metadata: str | None = None) -> str:
    _carry()
    return str(maturin.build_wheel(directory, settings, metadata))


def build_editable(directory: str, settings: Any = None, metadata: str | None = None) -> str:
    _carry()
    return str(maturin.build_editable(directory, settings, metadata))


def build_sdist(directory: str, settings: Any = None) -> str:
    raise SystemExit("a source distribution is the whole source tree: install from there, `pip install ./python`")
