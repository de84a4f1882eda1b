#!/usr/bin/env python3
"""CPU use of the daemon: shares of one core, idle and during a sweep with eight clients of its live events.

usage: cpu.py VELOMOTION LOG.pcapng

The drive is `velomotion firmware-sim` in a separate process. The lidar is a sender of the data and position packets of LOG (of any capture)
at the recorded rate, so that the measured process contains only the daemon. Needs only Linux and python3.
"""
import base64
import json
import os
import pathlib
import socket
import struct
import subprocess
import sys
import tempfile
import threading
import time
import urllib.request

IDLE_S, SPEED = 60.0, 1.0


def packets(path):
    """Ethernet frames of interface 0: (seconds, port, payload)."""
    data, at, out = pathlib.Path(path).read_bytes(), 0, []
    while at + 12 <= len(data):
        kind, length = struct.unpack_from("<II", data, at)
        if kind == 6:
            interface, high, low, captured = struct.unpack_from("<IIII", data, at + 8)
            frame = data[at + 28 : at + 28 + captured]
            if interface == 0 and len(frame) > 42:
                out.append(((high << 32 | low) * 1e-9, struct.unpack_from(">H", frame, 36)[0], frame[42:]))
        at += length
    return out


def whole_turns(recorded):
    """The packets of complete revolutions, which can be repeated, and their duration by the lidar's clock, microseconds."""
    data = [i for i, (_, port, _) in enumerate(recorded) if port == 2368]
    stamp = lambda i: struct.unpack_from("<I", recorded[i][2], 1200)[0]
    azimuth = lambda i: struct.unpack_from("<H", recorded[i][2], 2)[0]
    begin = data[0]
    # The packet with the azimuth of the first one starts the next round.
    end = min(data[len(data) // 2 :], key=lambda i: (abs((azimuth(i) - azimuth(begin) + 18_000) % 36_000 - 18_000), i))
    return recorded[begin:end], (stamp(end) - stamp(begin)) % 3_600_000_000


def lidar(recorded, ports, stop):
    out = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    recorded, round_us = whole_turns(recorded)
    start, first, turn = time.monotonic(), recorded[0][0], 0
    while not stop.is_set():
        for at, port, payload in recorded:
            due = start + turn * round_us * 1e-6 + at - first
            if due > time.monotonic() + 0.005:
                time.sleep(due - time.monotonic())
            # The lidar's clock continues from round to round, in both kinds of packets.
            place = 1200 if port == 2368 else 198
            stamp = (struct.unpack_from("<I", payload, place)[0] + turn * round_us) % 3_600_000_000
            payload = payload[:place] + struct.pack("<I", stamp) + payload[place + 4 :]
            out.sendto(payload, ("127.0.0.1", ports[port]))
            if stop.is_set():
                return
        turn += 1


def client(address, stop, counts, index):
    host, port = address.split(":")
    s = socket.create_connection((host, int(port)))
    key = base64.b64encode(os.urandom(16)).decode()
    s.sendall(f"GET /api/v1/events HTTP/1.1\r\nHost: {address}\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n"
              f"Sec-WebSocket-Version: 13\r\nSec-WebSocket-Key: {key}\r\n\r\n".encode())
    while not stop.is_set():
        piece = s.recv(1 << 20)
        if not piece:
            return
        counts[index] += len(piece)


def call(address, path, body=None):
    data = None if body is None else json.dumps(body).encode()
    request = urllib.request.Request(f"http://{address}{path}", data, {"Content-Type": "application/json"})
    return json.load(urllib.request.urlopen(request))


def threads(pid):
    out = {}
    for task in pathlib.Path(f"/proc/{pid}/task").iterdir():
        try:
            text = (task / "stat").read_text()
        except FileNotFoundError:
            continue
        name, rest = text[text.index("(") + 1 : text.rindex(")")], text[text.rindex(")") + 2 :].split()
        out[task.name] = (name, (int(rest[11]) + int(rest[12])) / os.sysconf("SC_CLK_TCK"))
    return out


def spent(pid):
    text = pathlib.Path(f"/proc/{pid}/stat").read_text()
    rest = text[text.rindex(")") + 2 :].split()
    return (int(rest[11]) + int(rest[12])) / os.sysconf("SC_CLK_TCK")


def measure(pid, run):
    before, parts, begin = spent(pid), threads(pid), time.monotonic()
    run()
    took = time.monotonic() - begin
    used, share = threads(pid), {}
    for task, (name, seconds) in used.items():
        share[name] = share.get(name, 0) + (seconds - parts.get(task, (name, 0))[1]) / took * 100
    listed = ", ".join(f"{name} {percent:.2f}" for name, percent in sorted(share.items(), key=lambda s: -s[1]) if percent >= 0.01)
    return f"{(spent(pid) - before) / took * 100:.2f} % of a core over {took:.0f} s ({listed})"


def main():
    program, log = os.path.abspath(sys.argv[1]), sys.argv[2]
    recorded = packets(log)
    with tempfile.TemporaryDirectory() as folder:
        free = [socket.socket(socket.AF_INET, socket.SOCK_DGRAM) for _ in range(2)]
        for one in free:
            one.bind(("127.0.0.1", 0))
        data, position = (one.getsockname()[1] for one in free)
        for one in free:
            one.close()
        drive = subprocess.Popen([program, "firmware-sim", "--usb", "--link", f"{folder}/epos"], stdin=subprocess.PIPE, stdout=subprocess.PIPE)
        drive.stdout.readline()
        pathlib.Path(folder, "velomotion.toml").write_text(
            f"[device]\ndefault = 'bench'\n[device.bench]\nkind = 'usb'\nport = '{folder}/epos'\nlidar = '127.0.0.1'\n"
            f"data_port = {data}\nposition_port = {position}\n[daemon]\nreserve_bytes = 1000\nscans = '{folder}/scans'\n")
        daemon = subprocess.Popen([program, "daemon", "--listen", "127.0.0.1:0", "--json"], cwd=folder, stdout=subprocess.PIPE,
                                  env={**os.environ, "XDG_RUNTIME_DIR": folder})
        address = json.loads(daemon.stdout.readline())["address"]
        stop, counts = threading.Event(), [0] * 8
        threading.Thread(target=lidar, args=(recorded, {2368: data, 8308: position}, stop), daemon=True).start()
        while any(call(address, "/api/v1/status")[which]["state"] != "connected" for which in ("drive", "lidar")):
            time.sleep(0.1)
        print("idle:", measure(daemon.pid, lambda: time.sleep(IDLE_S)))
        for index in range(8):
            threading.Thread(target=client, args=(address, stop, counts, index), daemon=True).start()
        begun = call(address, "/api/v1/captures", {"speed_deg_s": SPEED})
        while call(address, "/api/v1/status")["activity"]["step"] == 0:
            time.sleep(0.1)
        time.sleep(2)

        def sweep():
            while (activity := call(address, "/api/v1/status")["activity"])["scan"] == begun["id"] and activity["left_s"] > 2:
                time.sleep(1)

        before = list(counts)
        print("sweeping, 8 clients:", measure(daemon.pid, sweep))
        print(f"each client took {(counts[0] - before[0]) / 1e6:.0f} MB in that time")
        while (scan := call(address, f"/api/v1/scans/{begun['id']}"))["state"] in ("recording", "making"):
            time.sleep(0.5)
        status = call(address, "/api/v1/status")
        print(f"{scan['state']} ({(scan['why'] or {}).get('error')}): {scan['points']} points, {scan['lost_records']} records lost, {status['clients']['dropped']} clients dropped")
        memory = [line for line in pathlib.Path(f"/proc/{daemon.pid}/status").read_text().splitlines() if line.startswith(("VmHWM", "VmRSS"))]
        print("memory:", "; ".join(" ".join(line.split()) for line in memory))
        stop.set()
        daemon.terminate()
        daemon.wait()
        drive.stdin.close()
        drive.wait()


main()
