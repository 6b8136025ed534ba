"""Files that the package carries: the program, the libraries of its FMUs, and two FMUs."""

from __future__ import annotations

import os
import sys
from pathlib import Path

_HERE = Path(__file__).resolve().parent
_PROGRAM = "master.exe" if sys.platform == "win32" else "master"


def program() -> Path:
    """Path of the program ``master`` that the package carries."""
    return _HERE / "bin" / _PROGRAM


def fmus() -> dict[str, Path]:
    """Paths of ``Catenary.fmu`` and ``Pantograph.fmu`` of the shipped scene of EN 50318 at 300 km/h.

    FMUs of another scene: ``master package SCENE``.
    """
    return {path.stem: path for path in sorted((_HERE / "fmus").glob("*.fmu"))}


def main() -> None:
    """Becomes the program; the entry point ``master`` of the package."""
    path = os.fspath(program())
    if sys.platform == "win32":
        import subprocess

        raise SystemExit(subprocess.run([path, *sys.argv[1:]], check=False).returncode)
    os.execv(path, [path, *sys.argv[1:]])
