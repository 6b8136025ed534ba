"""Fixtures: the packaged FMUs and their reference trajectories."""
import pytest

from driver import SCENES, Fmu


def pytest_addoption(parser):
    parser.addoption("--data", required=True, help="folder with the FMUs and what the core does")


def pytest_generate_tests(metafunc):
    cases = [(scene, kind) for scene in SCENES for kind in ("Catenary", "Pantograph")]
    if "fmu" in metafunc.fixturenames:
        metafunc.parametrize("fmu", cases, ids="-".join, indirect=True, scope="session")
    if "line" in metafunc.fixturenames:
        metafunc.parametrize("line", [case for case in cases if case[1] == "Catenary"], ids="-".join, indirect=True, scope="session")
    if "pair" in metafunc.fixturenames:
        metafunc.parametrize("pair", SCENES, indirect=True, scope="session")


@pytest.fixture(scope="session")
def opened(request, tmp_path_factory):
    """Opens each FMU once, in a folder whose name has to be encoded in a URI."""
    fmus = {}

    def get(scene, kind):
        if (scene, kind) not in fmus:
            folder = tmp_path_factory.mktemp("unpacked ü 100%41 ", numbered=True)
            fmus[scene, kind] = Fmu(request.config.getoption("--data"), scene, kind, folder)
        return fmus[scene, kind]

    return get


@pytest.fixture(scope="session")
def fmu(request, opened):
    return opened(*request.param)


@pytest.fixture(scope="session")
def line(request, opened):
    return opened(*request.param)


@pytest.fixture(scope="session")
def pair(request, opened):
    return opened(request.param, "Catenary"), opened(request.param, "Pantograph")
