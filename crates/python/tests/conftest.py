"""Recordings and logs of the tests; VELOMOTION_PROGRAM names the program to compare with."""

import json
import os
import shutil
import subprocess
from pathlib import Path

import pytest
import velomotion

ROOT = Path(__file__).resolve().parents[3]
RECORDINGS = ROOT / "tests" / "recordings"


@pytest.fixture(scope="session")
def tilted(tmp_path_factory):
    """A log of one sweep, with the drive's traffic."""
    log = tmp_path_factory.mktemp("tilted") / "rig.pcapng"
    velomotion.simulate("rig", log)
    return log


@pytest.fixture
def program(tmp_path, monkeypatch):
    """Runs the command line; its result is the object that it prints with --json."""
    name = os.environ.get("VELOMOTION_PROGRAM") or shutil.which("velomotion")
    assert name, "VELOMOTION_PROGRAM names the velomotion of this build"
    # No configuration of this machine, for the program and for plan.
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("HOME", str(tmp_path))
    monkeypatch.setenv("XDG_CONFIG_HOME", str(tmp_path))
    monkeypatch.setenv("PATH", str(Path(name).resolve().parent), prepend=os.pathsep)

    def run(*words):
        done = subprocess.run([name, *map(str, words), "--json"], capture_output=True, text=True)
        assert done.returncode in (0, 6), done.stderr
        return json.loads(done.stdout)

    return run
