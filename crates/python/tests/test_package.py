"""The package itself: types, docs, signals."""

import inspect
import os
import re
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest
import velomotion
from conftest import ROOT


def test_the_stub_has_the_signatures_of_the_module():
    done = subprocess.run([sys.executable, "-m", "mypy.stubtest", "velomotion"], capture_output=True, text=True)
    assert done.returncode == 0, done.stdout + done.stderr


def test_everything_is_documented():
    for name in velomotion.__all__:
        entry = getattr(velomotion, name)
        if not name.startswith("__"):
            assert inspect.getdoc(entry), name
    for method in ["info", "packets", "polls", "angles", "sweeps", "clocks"]:
        assert inspect.getdoc(getattr(velomotion.Log, method)), method
    version = re.search(r'^version = "(.*)"', (ROOT / "Cargo.toml").read_text(), re.M).group(1)
    assert velomotion.__version__ == version
    assert (Path(velomotion.__file__).parent / "py.typed").exists()


@pytest.mark.parametrize("work", ["velomotion.k('velomotion16:2', error=0)", "list(velomotion.frames(fifo))"])
def test_ctrl_c_stops_work(work, tmp_path):
    fifo = tmp_path / "fifo"
    os.mkfifo(fifo)
    code = f"import velomotion; fifo = {str(fifo)!r}; print('begins', flush=True); {work}"
    child = subprocess.Popen([sys.executable, "-c", code], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    assert child.stdout.readline() == "begins\n"
    time.sleep(0.5)
    child.send_signal(signal.SIGINT)
    _, errors = child.communicate(timeout=30)
    assert "KeyboardInterrupt" in errors and child.returncode != 0
