"""The examples and the book's page run as they are."""

import re
import subprocess
import sys

import nbclient
import nbformat
import numpy
import pytest
import velomotion
from dask.distributed import LocalCluster
from conftest import RECORDINGS, ROOT

EXAMPLES = ROOT / "crates" / "python" / "examples"


def test_the_notebook(tmp_path):
    notebook = nbformat.read(EXAMPLES / "first_cloud.ipynb", as_version=4)
    nbclient.NotebookClient(notebook, timeout=300, resources={"metadata": {"path": str(tmp_path)}}).execute()


def test_many_logs_on_a_local_cluster(tmp_path):
    logs = [tmp_path / f"{seed}.pcapng" for seed in range(3)]
    for seed, log in enumerate(logs):
        velomotion.simulate("room", log, seed=seed)
    expected = {log.name: len(velomotion.read(log)) for log in logs}
    with LocalCluster(n_workers=2, threads_per_worker=1, processes=True, dashboard_address=None) as cluster:
        for where in [["--workers", "2"], ["--scheduler", cluster.scheduler_address]]:
            command = [sys.executable, EXAMPLES / "many_logs.py", *where, *logs]
            done = subprocess.run(command, capture_output=True, text=True, timeout=300)
            assert done.returncode == 0, done.stderr
            table = [line.split() for line in done.stdout.splitlines()]
            points = {row[0]: int(row[1]) for row in table if row and row[0].endswith(".pcapng")}
            assert points == expected
            assert re.search(r" MB/s by [12] processes$", done.stdout.rstrip()), done.stdout


def test_the_comparison_of_speed_runs():
    """Once: it measures with more repetitions, and a release build."""
    command = [sys.executable, EXAMPLES / "speed.py", "--repetitions", "2", RECORDINGS / "vlp16-strongest-gps.pcap"]
    done = subprocess.run(command, capture_output=True, text=True, timeout=300)
    assert done.returncode == 0, done.stderr
    assert "velodyne-decoder" in done.stdout and "times" in done.stdout
    demanded = subprocess.run([*command, "--least", "1e9"], capture_output=True, text=True, timeout=300)
    assert demanded.returncode == 1 and "below 1e+09" in demanded.stderr


PAGES = ["docs/src/python.md", "docs/src/formats.md", "docs/src/open-a-cloud.md", "crates/python/README.md"]


@pytest.mark.parametrize("page", PAGES)
def test_the_python_of_a_page_runs(page, program, tmp_path):
    blocks = re.findall(r"^```python\n(.*?)^```$", (ROOT / page).read_text(), re.M | re.S)
    assert blocks
    (tmp_path / "walk.pcap").write_bytes((RECORDINGS / "vlp16-dual.pcap").read_bytes())
    (tmp_path / "mount.toml").write_text("[mount]\nd_m = 0.06\n")
    if "hall.pcapng" in "".join(blocks):
        velomotion.simulate("hall", "hall.pcapng")
        for cloud in ["hall.ply", "hall.laz"]:
            program("replay", "hall.pcapng", "-o", cloud)
    names = {}
    for block in blocks:
        exec(compile(block, page, "exec"), names)
    if (tmp_path / "hall.npz").exists():
        stored = numpy.load("hall.npz")["points"]
        points = velomotion.read("hall.pcapng")
        assert stored.dtype.names == points.dtype.names
        assert all(numpy.array_equal(stored[name], points[name]) for name in stored.dtype.names)
