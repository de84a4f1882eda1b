"""mcap with mcap-ros2-support, and rosbags, read an .mcap cloud and its metadata.yaml: counts, bounds and what messages say as JSON.

usage: mcap_reads.py CLOUD.mcap
"""

import json
import sys
from collections import Counter
from pathlib import Path

import numpy as np
from mcap.reader import make_reader
from mcap_ros2.decoder import DecoderFactory
from rosbags.rosbag2 import Reader
from rosbags.typesys import Stores, get_types_from_msg, get_typestore

path = Path(sys.argv[1])
KINDS = {2: "u1", 4: "<u2", 7: "<f4", 8: "<f8"}


def rows(message):
    """The points of a PointCloud2, by its own description."""
    kind = np.dtype(
        {
            "names": [field.name for field in message.fields],
            "formats": [KINDS[field.datatype] for field in message.fields],
            "offsets": [field.offset for field in message.fields],
            "itemsize": message.point_step,
        }
    )
    assert message.height == 1 and not message.is_bigendian and message.is_dense
    assert message.row_step == message.width * message.point_step == len(message.data)
    return np.frombuffer(bytes(message.data), kind)


def nanoseconds(stamp):
    return stamp.sec * 10**9 + getattr(stamp, "nanosec")


# mcap and its decoder, which goes by the definitions in the file.
counts, clouds, tilts, frames = Counter(), [], [], set()
stamps, log_times, checks, fields = [], [], {}, []
with path.open("rb") as file:
    reader = make_reader(file, decoder_factories=[DecoderFactory()])
    header = reader.get_header()
    encodings = {
        (channel.message_encoding, reader.get_summary().schemas[channel.schema_id].encoding)
        for channel in reader.get_summary().channels.values()
    }
    records = {record.name: record.metadata for record in reader.iter_metadata()}
    for _, channel, message, decoded in reader.iter_decoded_messages():
        counts[channel.topic] += 1
        log_times.append(message.log_time)
        if channel.topic == "/velomotion/points":
            fields = [field.name for field in decoded.fields]
            points = rows(decoded)
            frames.add(decoded.header.frame_id)
            clouds.append(points)
            stamps.append(nanoseconds(decoded.header.stamp))
        elif channel.topic == "/joint_states":
            assert list(decoded.name) == ["tilt"]
            tilts.append(decoded.position[0])
        elif channel.topic in ("/tf", "/tf_static"):
            for transform in decoded.transforms:
                frames.add(f"{transform.header.frame_id}/{transform.child_frame_id}")
        elif channel.topic == "/diagnostics":
            for status in decoded.status:
                level = status.level
                checks[status.name] = {
                    "level": level[0] if isinstance(level, bytes) else level,
                    "message": status.message,
                    "values": {value.key: value.value for value in status.values},
                }
# ROS's axes, x forward and y left, to those of the other files.
forward, left, up = (np.concatenate([cloud[axis] for cloud in clouds]) for axis in "xyz")
xyz = np.vstack([-left, forward, up])
times = np.concatenate([cloud["time"] for cloud in clouds])

# rosbags, which goes by metadata.yaml, and by the definitions of a ROS 2 distribution.
store = get_typestore(Stores.ROS2_JAZZY)
bag_counts, bag_points, same_bytes, same_types, latched = Counter(), 0, True, True, []
with Reader(path.parent) as bag:
    bag_messages = bag.message_count
    bag_duration = bag.duration
    for connection in bag.connections:
        kinds = get_types_from_msg(connection.msgdef.data, connection.msgtype)
        own = get_typestore(Stores.EMPTY)
        own.register(kinds)
        same_types &= own.hash_rihs01(connection.msgtype) == store.hash_rihs01(connection.msgtype)
        for quality in connection.ext.offered_qos_profiles:
            if quality.durability.name == "TRANSIENT_LOCAL":
                latched.append(connection.topic)
    for connection, _, raw in bag.messages():
        bag_counts[connection.topic] += 1
        decoded = store.deserialize_cdr(raw, connection.msgtype)
        same_bytes &= bytes(store.serialize_cdr(decoded, connection.msgtype)) == bytes(raw)
        if connection.topic == "/velomotion/points":
            bag_points += decoded.width

print(
    json.dumps(
        {
            "profile": header.profile,
            "encodings": sorted(encodings),
            "records": records,
            "counts": counts,
            "sorted": log_times == sorted(log_times),
            "points": int(xyz.shape[1]),
            "fields": fields,
            "min": xyz.min(axis=1).tolist(),
            "max": xyz.max(axis=1).tolist(),
            "least_time_s": float(times.min()),
            "stamps": stamps,
            "tilt_deg": [float(np.degrees(min(tilts))), float(np.degrees(max(tilts)))] if tilts else [],
            "frames": sorted(frames),
            "checks": checks,
            "bag_counts": bag_counts,
            "bag_messages": bag_messages,
            "bag_duration_ns": bag_duration,
            "bag_points": bag_points,
            "same_bytes": same_bytes,
            "same_types": same_types,
            "latched": latched,
            "log_span_ns": max(log_times) - min(log_times),
        }
    )
)
