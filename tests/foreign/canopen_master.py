"""A CANopen master that is not ours (PyPI canopen and python-can, over SLCAN) runs the simulated EPOS2.

usage: canopen_master.py PORT QC_OF_TARGET
Prints one JSON object with what it saw.
"""

import json
import sys
import time

import can
import canopen

port, target = sys.argv[1], int(sys.argv[2])
bus = can.Bus(interface="slcan", channel=port, bitrate=1_000_000, sleep_after_open=0.05)
network = canopen.Network(bus)
network.connect()
node = network.add_node(canopen.RemoteNode(1, None))
node.sdo.RESPONSE_TIMEOUT = 2.0
seen = {}


def read(index, sub=0, signed=False):
    return int.from_bytes(node.sdo.upload(index, sub), "little", signed=signed)


def write(index, value, size, sub=0):
    node.sdo.download(index, sub, value.to_bytes(size, "little", signed=value < 0))


def wait(what, condition, seconds=20.0):
    end = time.monotonic() + seconds
    while not condition():
        if time.monotonic() > end:
            raise SystemExit(f"waited {seconds} s for {what}; statusword {read(0x6041):04X}")


def control(word, bits, mask, what):
    write(0x6040, word, 2)
    wait(what, lambda: read(0x6041) & mask == bits)


# Who it is: a string by segmented transfer, numbers by expedited.
seen["name"] = node.sdo.upload(0x1008, 0).decode().rstrip("\0")
seen["vendor"] = read(0x1018, 1)
seen["device_type"] = read(0x1000)

# An object that is not there.
try:
    node.sdo.upload(0x5FFF, 0)
except canopen.SdoAbortedError as error:
    seen["abort"] = error.code

# Up to operation enabled, the state machine of CiA 402.
node.nmt.send_command(0x01)
write(0x6040, 0x80, 2)
states = []
for word, bits, what in [(0x06, 0x21, "ready"), (0x07, 0x23, "switched on"), (0x0F, 0x27, "operation enabled")]:
    control(word, bits, 0x6F, what)
    states.append(what)
seen["states"] = states

# Homing on the positive limit switch.
for index, value, size, sub in [
    (0x6060, 6, 1, 0),
    (0x6098, 18, 1, 0),
    (0x6099, 400, 4, 1),
    (0x6099, 40, 4, 2),
    (0x609A, 5000, 4, 0),
]:
    write(index, value, size, sub)
control(0x0F, 0x27, 0x6F, "enabled in homing mode")
write(0x6040, 0x1F, 2)
wait("homing attained", lambda: read(0x6041) & 0x3400 == 0x1400)
seen["homed_at"] = read(0x6064, signed=True)

# The angle and its time on SYNC: map TPDO1 in pre-operational, then run.
node.nmt.send_command(0x80)
time.sleep(0.05)
write(0x1800, 0x40000181 | 0x80000000, 4, 1)
write(0x1800, 1, 1, 2)
write(0x1A00, 0, 1)
write(0x1A00, 0x60640020, 4, 1)
write(0x1A00, 0x10130020, 4, 2)
write(0x1A00, 2, 1)
write(0x1800, 0x40000181, 4, 1)
stream = []
network.subscribe(0x181, lambda cob, data, stamp: stream.append(bytes(data)))
node.nmt.send_command(0x01)
time.sleep(0.05)

# A move in profile position, with 200 SYNCs while it runs.
for index, value, size, sub in [(0x6060, 1, 1, 0), (0x6081, 1000, 4, 0), (0x6083, 10000, 4, 0), (0x6084, 10000, 4, 0)]:
    write(index, value, size, sub)
write(0x6040, 0x0F, 2)
write(0x607A, target, 4)
write(0x6040, 0x1F, 2)
for _ in range(200):
    network.sync.transmit()
    time.sleep(0.002)
wait("target reached", lambda: read(0x6041) & 0x0400 != 0 and abs(read(0x6064, signed=True) - target) < 3)
seen["arrived_at"] = read(0x6064, signed=True)
positions = [int.from_bytes(d[:4], "little", signed=True) for d in stream]
times = [int.from_bytes(d[4:8], "little") for d in stream]
seen["tpdos"] = len(stream)
seen["tpdo_positions_distinct"] = len(set(positions))
# Two SYNCs may reach the drive in one microsecond where the machine was busy.
seen["tpdo_times_never_fall"] = all(b >= a for a, b in zip(times, times[1:]))

# An emergency: a target outside the software limits. It is received, and in the history.
received = []
node.emcy.add_callback(lambda error: received.append(error.code))
write(0x607D, -100, 4, 1)
write(0x607D, 100, 4, 2)
write(0x6040, 0x0F, 2)
write(0x607A, target, 4)
write(0x6040, 0x1F, 2)
wait("an emergency message", lambda: bool(received))
seen["emcy"] = received[0]
seen["history"] = read(0x1003, 1) & 0xFFFF

# Recovery, then every way of homing, each from where the one before has left the axis.
write(0x607D, 2**31 - 1, 4, 2)
write(0x607D, -(2**31), 4, 1)


def enabled():
    for word in (0x00, 0x80, 0x00, 0x06, 0x07):
        write(0x6040, word, 2)
    control(0x0F, 0x27, 0x6F, "enabled again")


homed = {}
for method in (1, 2, 7, 11, 17, 18, 23, 27, 33, 34, 35, -1, -2, -3, -4, 18):
    enabled()
    for index, value, size, sub in [
        (0x6060, 6, 1, 0),
        (0x6098, method, 1, 0),
        (0x6099, 3000, 4, 1),
        (0x6099, 400, 4, 2),
        (0x609A, 30000, 4, 0),
    ]:
        write(index, value, size, sub)
    write(0x6040, 0x1F, 2)
    wait(f"homing by method {method}", lambda: read(0x6041) & 0x3400 != 0)
    wait(f"the end of method {method}", lambda: read(0x6041) & 0x2000 != 0 or read(0x6041) & 0x1400 == 0x1400, 60.0)
    homed[str(method)] = read(0x6041) & 0x3400 == 0x1400
seen["homed"] = homed


def run_up():
    """Goes up, off any stop first, until a fault; returns what was received of it."""
    enabled()
    write(0x6060, 1, 1)
    write(0x6081, 2000, 4)
    write(0x607A, -3000, 4)
    write(0x6040, 0x1F, 2)
    wait("room above", lambda: read(0x6041) & 0x0400 != 0)
    write(0x1003, 0, 1)
    received.clear()
    write(0x6040, 0x0F, 2)
    write(0x607A, 100_000, 4)
    write(0x6040, 0x1F, 2)
    wait("a fault", lambda: read(0x6041) & 0x4F == 0x08)
    count = read(0x1003)
    wait("its emergency message", lambda: bool(received))
    return {"received": list(received), "history": [read(0x1003, sub) & 0xFFFF for sub in range(1, count + 1)]}


# A limit switch with its bit in the execution mask is one fault; without, the axis goes on to the mechanical stop.
write(0x2071, 0x000B, 2, 4)
seen["limit_switch"] = run_up()
write(0x2071, 0x0008, 2, 4)
seen["mechanical_stop"] = run_up()
enabled()
seen["enabled_again"] = read(0x6041) & 0x6F == 0x27
write(0x6040, 0x00, 2)
seen["error_register"] = read(0x1001)

# Layer setting services: found by its identity, its node id changed and stored.
identity = [read(0x1018, sub) for sub in range(1, 5)]
node.nmt.send_command(0x02)
lss = network.lss
seen["lss_selected"] = lss.send_switch_state_selective(*identity)
seen["lss_node_id"] = lss.inquire_node_id()
lss.configure_node_id(9)
lss.store_configuration()
lss.send_switch_state_global(lss.WAITING_STATE)
moved = network.add_node(canopen.RemoteNode(9, None))
states = []
moved.nmt.add_heartbeat_callback(states.append)
node.nmt.send_command(0x81)
wait("the boot-up of node 9", lambda: 0 in states)
seen["lss_moved_to"] = int.from_bytes(moved.sdo.upload(0x2000, 0), "little")

network.disconnect()
print(json.dumps(seen))
