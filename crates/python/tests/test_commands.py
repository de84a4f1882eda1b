"""plan, density, k, calibrate and simulate give what the commands give."""

import numpy as np
import pye57
import pytest
import velomotion
from conftest import RECORDINGS


def test_plan(program):
    told = program("plan", "--at", "20m", "--gap", "0.8deg", "--error", "9mm", "--device", "sim")
    assert velomotion.plan(at_m=20, gap_deg=0.8, error_mm=9, device="sim") == told
    assert told["chosen"]["command"].startswith("velomotion capture --speed")
    told = program("plan", "--lidar", "hdl32e", "--rpm", "600,1200", "--device", "sim")
    assert velomotion.plan(lidar="hdl32e", rpm=[600, 1200], device="sim") == told
    impossible = velomotion.plan(gap_deg=0.01, device="sim")
    assert impossible["unmet"] and not impossible.get("chosen")


@pytest.mark.parametrize("arguments, expected", [
    ({"at_m": -1}, "at_m: expected"),
    ({"time_s": -1}, "time_s: expected"),
    ({"range_sd_m": -1}, "range_sd_m: expected"),
    ({"range_sd_m": float("nan")}, "range_sd_m: expected"),
    ({"mount_sd_deg": -1}, "mount_sd_deg: expected"),
    ({"rpm": []}, "rpm: expected"),
    ({"from_deg": 10, "to_deg": 10}, "from_deg"),
    ({"lidar": "hdl32e", "rpm": 7}, "rpm: expected"),
])
def test_refusals_of_plan_name_its_arguments(arguments, expected):
    with pytest.raises(velomotion.Error) as refused:
        velomotion.plan(device="sim", **arguments)
    message = f"{refused.value} {refused.value.help}"
    assert expected in message and "--" not in message.replace("velomotion plan --help", "")


def test_density_and_k(program):
    (told,) = program("analyze", "velomotion16:50")["patterns"]
    density, k = velomotion.density("velomotion16:50"), velomotion.k("velomotion16:50")
    assert density["points"] == k["points"] == told["points"]
    for name, value in density["density"].items():
        assert told["density"][name] == value, name
    assert density["hole"]["radius_deg"] == pytest.approx(told["hole"]["radius_deg"])
    assert density["counts"].sum() == told["points"] and density["centres"].shape == (5120, 3)
    assert np.allclose(np.linalg.norm(density["centres"], axis=1), 1)
    assert np.allclose(k["d"], told["k"]["d"]) and np.allclose(k["theta_deg"], told["k"]["theta_deg"])
    assert np.allclose(k["k_minus_csr"], told["k"]["k_minus_csr"]) and k["method"] == told["k"]["method"]


def test_density_of_points(tilted, program):
    (told,) = program("analyze", tilted)["patterns"]
    points = velomotion.read(tilted)
    density = velomotion.density(points)
    assert density["points"] == told["points"]
    # Single precision moves a few points into the next bin.
    assert density["density"]["sd"] == pytest.approx(told["density"]["sd"], rel=1e-3)
    xyz = np.column_stack([points["x"], points["y"], points["z"]])
    assert np.array_equal(velomotion.density(xyz)["counts"], density["counts"])
    # Rows of 25 bytes, as other libraries have them: their columns are not aligned.
    packed = np.zeros(len(xyz), dtype=[("at", "f8", 3), ("kind", "u1")])
    packed["at"] = xyz
    assert np.array_equal(velomotion.density(packed["at"])["counts"], density["counts"])
    moved = velomotion.density(xyz + [1, 2, 3], origin=(1, 2, 3))["counts"]
    assert np.abs(moved.astype(int) - density["counts"]).sum() < 0.001 * len(points)
    beyond = velomotion.density(np.vstack([xyz, np.zeros((5, 3)), np.full((2, 3), np.nan)]))
    assert beyond["without_direction"] == 7 and np.array_equal(beyond["counts"], density["counts"])
    curve = velomotion.k(points, error=1e-3)
    assert np.abs(curve["d"] - np.interp(curve["theta_deg"], told["k"]["theta_deg"], told["k"]["d"])).max() < 2e-3


def test_simulate(program, tmp_path):
    ours, theirs = tmp_path / "ours.pcapng", tmp_path / "theirs.pcapng"
    report = velomotion.simulate("room", ours, truth=tmp_path / "truth.ply", seed=7)
    told = program("simulate", "room", "--seed", 7, "-o", theirs)
    assert ours.read_bytes() == theirs.read_bytes() and (tmp_path / "truth.ply").stat().st_size > 1_000_000
    for name in ["packets", "shots", "returned", "returns", "effects", "warnings", "seed"]:
        assert report[name] == told[name], name
    with pytest.raises(velomotion.UsageError, match="exists"):
        velomotion.simulate("room", ours)
    plain = velomotion.simulate("room", ours, without=["all"], force=True)
    assert plain["effects"] == []


def test_calibrate(program, tmp_path):
    scene = tmp_path / "scene.toml"
    scene.write_text(
        'scene = "hall"\nseed = 1\n[motion]\nkind = "sweeps"\nfrom_deg = 0\nto_deg = -45\nspeed_deg_s = 56.25\n'
        "accel_deg_s2 = 500\ncount = 2\nboth_ways = true\n[mount]\nd_m = 0.06\nrotation_deg = [0.3, 0, -0.2]\n"
    )
    log, mount = tmp_path / "scan.pcapng", tmp_path / "mount.toml"
    velomotion.simulate(scene, log)
    drawing = tmp_path / "drawing.toml"
    drawing.write_text("[mount]\nd_m = 0.06\n")
    made = velomotion.calibrate(log, mount=drawing, fix=["laser"])
    told = program("calibrate", log, "--mount", drawing, "--fix", "laser", "-o", mount)
    value = {parameter["name"]: parameter["value"] for parameter in made["parameters"]}
    assert value["mount_rotation_x_deg"] == pytest.approx(0.3, abs=0.01)
    toml = made.pop("toml")
    assert told.pop("output") == str(mount) and told.pop("schema") == made.pop("schema") and made == told
    # Apart from the commit in the version.
    lines = [[line for line in text.splitlines() if not line.startswith("velomotion = ")] for text in (toml, mount.read_text())]
    assert lines[0] == lines[1] and len(lines[0]) > 10
    (tmp_path / "made.toml").write_text(toml)
    calibrated = velomotion.read(log, mount=tmp_path / "made.toml")
    assert len(calibrated) == len(velomotion.read(log, mount=0.06)) > 100_000


def test_pye57_turns_a_georeferenced_scan_to_north(program, tmp_path):
    clouds = [tmp_path / "walk.e57", tmp_path / "walk.csv"]
    for cloud in clouds:
        recording = RECORDINGS / "vlp16-strongest-gps.pcap"
        program("replay", recording, "--tilt", "none", "--georeference", "250deg", "-o", cloud)
    scan = pye57.E57(str(clouds[0])).read_scan(0)
    placed = np.column_stack([scan["cartesianX"], scan["cartesianY"], scan["cartesianZ"]])
    expected = np.loadtxt(clouds[1], delimiter=",", comments=["#", "x_m"], usecols=(0, 1, 2))
    assert placed.shape == expected.shape and np.abs(placed - expected).max() < 1e-5
