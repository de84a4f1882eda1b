"""Points: their fields, and the same as the command line's and another decoder's."""

import os
import subprocess
import sys
import time

import numpy as np
import pytest
import velodyne_decoder as vd
import velomotion
from conftest import RECORDINGS

USUAL = ["x", "y", "z", "range", "azimuth", "tilt", "time", "intensity", "ring", "laser", "echo"]


def positions(points):
    return np.column_stack([points["x"], points["y"], points["z"]]).astype(float)


def ignore_incomplete(call):
    with pytest.warns(velomotion.IncompleteWarning):
        return call()


def test_rows_are_as_documented_and_not_copied(tmp_path):
    points = velomotion.read(RECORDINGS / "vlp16-dual.pcap")
    assert list(points.dtype.names) == USUAL and points.ndim == 1 and len(points) > 1_000
    assert points.dtype["x"] == np.float32 and points.dtype["time"] == np.float64
    assert points.dtype["ring"] == np.uint8 and points.dtype.itemsize == 40
    # numpy.save and numpy.savez need the order of the bytes.
    offsets = [points.dtype.fields[name][1] for name in USUAL]
    assert offsets == sorted(offsets)
    # A view of the memory that Rust allocated.
    assert not points.flags.owndata and points.flags.aligned and points.flags.writeable
    some = velomotion.read(RECORDINGS / "vlp16-dual.pcap", fields=["intensity", "x", "device_time"])
    # With padding between fields.
    np.save(tmp_path / "some.npy", some)
    saved = np.load(tmp_path / "some.npy")
    assert all(np.array_equal(saved[name], some[name]) for name in some.dtype.names)
    assert list(some.dtype.names) == ["intensity", "x", "device_time"] and some.dtype.itemsize == 16
    assert np.array_equal(some["x"], points["x"]) and np.array_equal(some["intensity"], points["intensity"])
    for name in velomotion.read.__doc__.split("Returns")[1].split("Warns")[0].split("- ")[1:]:
        for field in name.split(" (")[0].split(", "):
            velomotion.read(RECORDINGS / "vlp16-fov-limited-malformed.pcap", fields=[field])


def test_range_and_azimuth_are_those_of_the_position():
    points = velomotion.read(RECORDINGS / "vlp16-strongest-gps.pcap")
    xyz = positions(points)
    assert np.abs(np.linalg.norm(xyz, axis=1) - points["range"]).max() < 1e-4
    azimuth = np.degrees(np.arctan2(xyz[:, 0], xyz[:, 1])) % 360
    turn = np.abs(azimuth - points["azimuth"])
    assert np.minimum(turn, 360 - turn).max() < 1e-4
    assert 0 <= points["azimuth"].min() and points["azimuth"].max() < 360
    assert (points["tilt"] == 0).all() and (np.diff(points["time"]) > -1e-3).all()


def decoded(path, model="VLP16"):
    """The points of PyPI's velodyne-decoder, x right and y forward."""
    config = vd.Config(model=getattr(vd.Model, model), min_range=0.0, max_range=1000.0)
    scans = [points for _, points in vd.read_pcap(str(path), config, as_pcl_structs=True)]
    theirs = np.concatenate(scans)
    xyz = np.column_stack([-theirs["y"], theirs["x"], theirs["z"]]).astype(float)
    # It keeps measurements without a return.
    return xyz, theirs


@pytest.mark.parametrize("name", ["vlp16-strongest-gps", "vlp16-dual"])
def test_velodyne_decoder_has_the_same_points(name):
    path = RECORDINGS / f"{name}.pcap"
    theirs, rows = decoded(path)
    ours = velomotion.read(path, equal_returns="once")
    assert len(ours) == len(theirs)
    assert np.array_equal(ours["ring"], rows["ring"])
    assert np.array_equal(ours["intensity"], rows["intensity"].astype(np.uint8))
    # They round azimuths to 0.01 deg and the rotor's steps (docs/src/peers.md); apart from that points agree to a
    # tenth of a millimetre.
    azimuth = np.degrees(np.arctan2(theirs[:, 0], theirs[:, 1])) % 360
    turn = np.abs((ours["azimuth"] - azimuth + 180) % 360 - 180)
    assert turn.max() < 0.03 and turn.mean() < 0.01
    assert np.abs(np.hypot(theirs[:, 0], theirs[:, 1]) - np.hypot(ours["x"], ours["y"])).max() < 1e-4
    assert np.abs(theirs[:, 2] - ours["z"]).max() < 1e-4


def test_a_tilted_log_is_placed_as_the_paper_says(tilted):
    placed = velomotion.read(tilted, fields=[*USUAL, "device_time"])
    own = velomotion.read(tilted, tilt="none", fields=[*USUAL, "device_time"])
    assert len(own) > len(placed) > 100_000 and placed["tilt"].min() < -44.9
    key = [("device_time", "f8"), ("laser", "u1")]
    keys = [np.array(list(zip(rows["device_time"], rows["laser"])), dtype=key) for rows in (placed, own)]
    _, at, of = np.intersect1d(*keys, return_indices=True)
    assert len(at) == len(placed)
    placed, own = placed[at], own[of]
    # Eq. 4-6: the lidar is 6 cm above the tilt axis, which is y.
    tilt = np.radians(placed["tilt"].astype(float))
    height = own["z"] + 0.06
    x = own["x"] * np.cos(tilt) + height * np.sin(tilt)
    z = height * np.cos(tilt) - own["x"] * np.sin(tilt)
    expected = np.column_stack([x, own["y"], z])
    assert np.abs(expected - positions(placed)).max() < 2e-5
    # Range and azimuth are the lidar's own in both.
    assert np.abs(own["range"] - placed["range"]).max() < 1e-5
    turn = np.abs(own["azimuth"] - placed["azimuth"])
    assert np.minimum(turn, 360 - turn).max() < 1e-4


def test_rows_are_those_of_velomotion_replay(tilted, program, tmp_path):
    cloud = tmp_path / "cloud.csv"
    report = program("replay", tilted, "-o", cloud, "--uncertainty")
    rows = np.genfromtxt([line for line in cloud.open() if not line.startswith("#")], delimiter=",", names=True)
    ours = velomotion.read(tilted, fields=[*USUAL, "sd"])
    assert report["points"] == len(ours) == len(rows)
    for field, column, within in [
        ("x", "x_m", 1e-5), ("y", "y_m", 1e-5), ("z", "z_m", 1e-5), ("time", "time_s", 1e-6), ("tilt", "tilt_deg", 1e-5),
        ("intensity", "intensity", 0), ("ring", "ring", 0), ("sd", "sd_m", 1e-8),
    ]:
        assert np.abs(ours[field] - rows[column]).max() <= within, field


@pytest.mark.parametrize("cut", [0.0, 180.0])
def test_frames_are_the_recording_revolution_by_revolution(tilted, program, tmp_path, cut):
    for path in [RECORDINGS / "vlp16-dual.pcap", RECORDINGS / "hdl32e-strongest.pcap", tilted]:
        frames = list(velomotion.frames(path, cut=cut))
        points = velomotion.read(path)
        joined = np.concatenate(frames)
        assert frames[0].dtype == points.dtype and len(joined) == len(points)
        assert np.abs(positions(joined) - positions(points)).max() < 1e-5
        for field in ["intensity", "ring", "laser", "echo"]:
            assert np.array_equal(joined[field], points[field])
        # Each whole revolution begins and ends at the cut.
        for frame in frames[1:-1]:
            if path != tilted:
                first, last = ((frame["azimuth"][end] - cut + 180) % 360 - 180 for end in (0, -1))
                assert -0.5 < first < 3 and -3 < last < 0.5
    # As many as replay writes for the log.
    report = program("replay", tilted, f"--frames={cut}", "-o", tmp_path / "frame.csv")
    assert report["clouds"] == len(frames)


def test_an_iterator_that_is_left_ends_its_reader(tilted):
    def threads():
        return len(os.listdir("/proc/self/task"))

    before = threads()
    for _ in range(8):
        frames = velomotion.frames(tilted)
        assert len(next(frames)) > 0
        del frames
    deadline = time.monotonic() + 20
    while threads() > before and time.monotonic() < deadline:
        time.sleep(0.01)
    assert threads() <= before


@pytest.mark.parametrize("call", ["len(velomotion.read(fifo))", "sum(map(len, velomotion.frames(fifo)))"])
def test_other_threads_run_while_a_recording_is_read(call, tmp_path):
    """The recording comes from a thread of the same interpreter: with its lock held both would wait for ever."""
    fifo = tmp_path / "fifo"
    os.mkfifo(fifo)
    path = RECORDINGS / "vlp16-dual.pcap"
    code = f"""
import threading, velomotion
fifo = {str(fifo)!r}
def write():
    with open({str(path)!r}, "rb") as source, open(fifo, "wb") as pipe:
        pipe.write(source.read())
threading.Thread(target=write).start()
print({call})
"""
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, timeout=60)
    assert done.returncode == 0 and int(done.stdout) == len(velomotion.read(path)), done.stderr


def test_angles_come_from_a_table_or_an_array(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("HOME", str(tmp_path))
    path = RECORDINGS / "vlp16-strongest-gps.pcap"
    level = velomotion.read(path)
    angles = np.array([[-1.0, 0.0], [3000.0, 3001.0]])
    table = tmp_path / "angles.csv"
    table.write_text("time_s,angle_deg\n" + "".join(f"{t},{a}\n" for t, a in angles))
    by_array = velomotion.read(path, tilt=angles, mount=0.06)
    by_table = velomotion.read(path, tilt=table, mount=0.06)
    assert np.array_equal(by_array, by_table) and len(by_array) == len(level)
    assert np.abs(by_array["range"] - level["range"]).max() < 1e-5
    since = by_array["time"] - by_array["time"][0]
    assert np.abs(by_array["tilt"] - by_array["tilt"][0] - since * 1.0).max() < 1e-2
    mount = tmp_path / "mount.toml"
    mount.write_text("[mount]\nd_m = 0.06\n")
    assert np.array_equal(velomotion.read(path, tilt=angles, mount=mount), by_array)
    with pytest.raises(velomotion.UsageError, match="mount"):
        velomotion.read(path, tilt=angles)
    with pytest.raises(velomotion.UsageError, match="sd"):
        velomotion.read(path, tilt=angles, mount=0.06, fields=["sd"])


def test_what_is_missing_is_a_warning(tmp_path):
    whole = (RECORDINGS / "vlp16-dual.pcap").read_bytes()
    cut = tmp_path / "cut.pcap"
    cut.write_bytes(whole[: len(whole) // 2 + 7])
    points = ignore_incomplete(lambda: velomotion.read(cut))
    frames = ignore_incomplete(lambda: list(velomotion.frames(cut)))
    assert 0 < len(points) == sum(map(len, frames))


def test_what_replay_warns_of_is_a_warning():
    path = RECORDINGS / "vlp16-strongest-gps.pcap"
    # Both have one spacing of packets; points of the one are up to 1.6 m off as those of the other.
    with pytest.warns(velomotion.RecordingWarning, match="factory byte says VLP-16; decoded as Puck Hi-Res as asked"):
        velomotion.read(path, model="hi-res")
    with pytest.warns(velomotion.RecordingWarning, match="returns were omitted"):
        some = velomotion.read(path, tilt=[[0, 0], [0.01, 1]], mount=0.06)
    assert 0 < len(some) < len(velomotion.read(path)) / 2
    with pytest.raises(velomotion.UsageError, match="row 3 is half a revolution"):
        velomotion.read(path, tilt=[[0, 358], [0.1, 359.9], [0.2, 1.8]], mount=0.06)


def test_errors_are_pythons(tmp_path):
    path = RECORDINGS / "vlp16-dual.pcap"
    missing = tmp_path / "missing.pcap"
    for call in [lambda: velomotion.read(missing), lambda: velomotion.frames(missing), lambda: velomotion.Log(missing),
                 lambda: velomotion.read(tmp_path), lambda: velomotion.read(path, calibration=missing),
                 lambda: velomotion.read(path, tilt=missing), lambda: velomotion.read(path, tilt=[[0, 0], [1, 1]], mount=missing),
                 lambda: velomotion.calibrate([missing]), lambda: velomotion.simulate(missing, tmp_path / "log.pcapng"),
                 lambda: velomotion.plan(config=missing)]:
        with pytest.raises(velomotion.FileError) as error:
            call()
        assert isinstance(error.value, OSError) and isinstance(error.value, velomotion.Error)
    for call in [lambda: velomotion.read(path, fields=["X"]), lambda: velomotion.read(path, fields=[]),
                 lambda: velomotion.read(path, fields=["x", "x"]), lambda: velomotion.read(path, time="gps"),
                 lambda: velomotion.read(path, model="vlp64"), lambda: velomotion.read(path, sensor="lidar"),
                 lambda: velomotion.read(path, equal_returns="no"), lambda: velomotion.read(path, mount=0.06),
                 lambda: velomotion.read(path, tilt=[1, 2, 3]), lambda: velomotion.read(path, tilt=[[0, 0, 0]]),
                 lambda: velomotion.read(path, tilt=[[1, 0], [0, 0]], mount=0.06),
                 lambda: velomotion.read(path, tilt=[[0, 0], [1, 1]], mount=float("nan")),
                 lambda: list(velomotion.frames(path, cut=float("inf"))), lambda: velomotion.density("vlp17"),
                 lambda: velomotion.density(np.zeros((3, 3))), lambda: velomotion.density(np.ones((3, 2))),
                 lambda: velomotion.density("vlp16", level=99), lambda: velomotion.k("vlp16", bins=0),
                 lambda: velomotion.k("vlp16", bins=3601), lambda: velomotion.k("vlp16", error=-1),
                 lambda: velomotion.k("vlp16", error=float("nan")), lambda: velomotion.frames(path, cut=1e30),
                 lambda: velomotion.density(np.ones((3, 3)), origin=(float("nan"), 0, 0)),
                 lambda: velomotion.k("vlp16", origin=(0, 0, 0)), lambda: velomotion.plan(lidar="os1"),
                 lambda: velomotion.plan(rpm="fast"), lambda: velomotion.plan(at_m=-1),
                 lambda: velomotion.simulate("hall", tmp_path / "log.pcapng", without=["rain"]),
                 lambda: velomotion.simulate("hall", tmp_path / "log.pcapng", tolerance="no"),
                 lambda: velomotion.simulate("hall", tmp_path / "log.ply"), lambda: velomotion.calibrate([])]:
        with pytest.raises(velomotion.UsageError) as error:
            call()
        assert isinstance(error.value, ValueError) and str(error.value)
    garbage = tmp_path / "garbage.pcap"
    garbage.write_bytes(b"no recording" * 100)
    for call in [lambda: velomotion.read(garbage), lambda: list(velomotion.frames(garbage)), lambda: velomotion.Log(garbage),
                 lambda: velomotion.read(path, tilt="log"), lambda: velomotion.calibrate(path),
                 lambda: velomotion.simulate(garbage, tmp_path / "log.pcapng")]:
        with pytest.raises(velomotion.InputError) as error:
            call()
        assert error.value.help
    with pytest.raises(TypeError):
        velomotion.read()
