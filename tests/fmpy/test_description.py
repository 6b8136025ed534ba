"""Checks of the archives by FMPy."""
import zipfile

from fmpy.validation import validate_fmu


def test_validate_reports_no_problem(fmu):
    assert validate_fmu(str(fmu.path)) == []


def test_the_archive_holds_what_belongs_into_it_and_nothing_else(fmu):
    with zipfile.ZipFile(fmu.path) as archive:
        names = archive.namelist()
    assert names == sorted(names)
    for name in names:
        assert not name.startswith("/") and ".." not in name and "\\" not in name and name.isascii()
        assert name == "modelDescription.xml" or name.split("/")[0] in ("binaries", "resources", "documentation")
    assert {"resources/scene.toml", "documentation/index.html", "documentation/licenses/license.txt"} <= set(names)


def test_every_output_says_what_it_depends_on(fmu):
    for unknown in fmu.description.outputs:
        assert unknown.dependencies is not None, unknown.variable.name
