"""What a log holds."""

import numpy as np
import pytest
import velomotion
from conftest import RECORDINGS


def test_a_log_shows_its_drive(tilted, program):
    log = velomotion.Log(tilted)
    info = log.info()
    described = program("info", tilted)
    assert info.pop("incomplete") is None and info == described
    polls, angles, sweeps = log.polls(), log.angles(), log.sweeps()
    assert len(polls) == info["tilt"]["samples"] and (polls["answer_ns"] > polls["request_ns"]).all()
    assert not polls["at_sync"].any()
    # One gear for all.
    moved = polls[polls["position_qc"] != 0]
    per_count = moved["angle_deg"] / moved["position_qc"]
    assert len(moved) > 100 and np.ptp(per_count) < 1e-9 * per_count[0]
    assert 0.8 * len(polls) < len(angles) <= len(polls)
    # Each is that of a poll, in the middle of its count.
    nearest = np.abs(angles["angle_deg"][:, None] - polls["angle_deg"]).min(axis=1)
    assert nearest.max() < per_count[0] and (np.diff(angles["host_ns"]) > 0).all()
    (sweep,) = sweeps
    assert (sweep["from_deg"], sweep["to_deg"]) == pytest.approx((0, -45), abs=0.01)
    assert sweep["cruise_deg_s"] == pytest.approx(-56.25, abs=0.1)
    assert sweep["commanded_deg_s"] == pytest.approx(56.25)
    reported = info["sweeps"][0]
    assert (sweep["end_ns"] - sweep["start_ns"]) * 1e-9 == pytest.approx(reported["duration_s"])


def test_the_clocks_fit(tilted):
    clocks = velomotion.Log(tilted).clocks()
    info = velomotion.Log(tilted).info()
    assert len(clocks) == info["packets"]["data"]
    delay = clocks["received_ns"] - clocks["host_ns"]
    # The fit is a lower envelope: no packet is earlier by more than the bound.
    assert (delay >= -clocks["bound_ns"]).all() and np.median(delay) < 1e6
    # VLP-16: 24 firings of 55.296 us per packet.
    assert np.median(np.diff(clocks["device_ns"])) == pytest.approx(24 * 55_296, abs=1_000)


def test_packets_are_the_bytes_of_the_file():
    path = RECORDINGS / "vlp16-strongest-gps.pcap"
    log = velomotion.Log(path)
    packets = log.packets()
    info = log.info()
    data = packets[packets["length"] == 1206]
    assert len(data) == info["packets"]["data"]
    assert len(packets) - len(data) == info["packets"]["position"] > 0
    assert set(data["port"]) == {2368} and set(packets["port"]) == {2368, 8308}
    whole = path.read_bytes()
    assert all(packet["payload"][: packet["length"]].tobytes() in whole for packet in packets[::50])
    assert (data["payload"][:, :2] == [0xFF, 0xEE]).all()


def test_a_plain_recording_has_no_drive():
    log = velomotion.Log(RECORDINGS / "vlp16-dual.pcap")
    assert len(log.polls()) == 0 and log.polls().dtype["angle_deg"] == np.float64
    assert log.info()["model"] == "VLP-16" and len(log.clocks()) == log.info()["packets"]["data"] > 10
    with pytest.raises(velomotion.InputError):
        log.sweeps()
    with pytest.raises(velomotion.InputError):
        log.angles()
