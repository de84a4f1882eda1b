"""A peer of the daemon on zenoh: a router, or a client of one, that does what ROS 2 nodes with rmw_zenoh do, and decodes what it hears with rosbags.

usage: peer.py router|client tcp/HOST:PORT FOLDER

Reads commands, a JSON object a line, and writes what happens, likewise. Clouds of whole sweeps and raw packets are written to
FOLDER as they came.
"""

import json
import sys
import threading
import time
from pathlib import Path

import numpy as np
import zenoh
import zenoh.ext
from rosbags.interfaces import Nodetype
from rosbags.typesys import Stores, get_types_from_msg, get_typestore
from zenoh_ros2_sdk import discovery
from zenoh_ros2_sdk.attachment import Attachment
from zenoh_ros2_sdk.qos import QosProfile

mode, endpoint, folder = sys.argv[1], sys.argv[2], Path(sys.argv[3])
store = get_typestore(Stores.ROS2_JAZZY)
# As in the repository ros-drivers/velodyne, branch ros2.
PACKET, SCAN = "velodyne_msgs/msg/VelodynePacket", "velodyne_msgs/msg/VelodyneScan"
store.register(get_types_from_msg("builtin_interfaces/Time stamp\nuint8[1206] data\n", PACKET))
store.register(get_types_from_msg("std_msgs/Header header\nVelodynePacket[] packets\n", SCAN))
# Of the package velomotion_msgs; the types of an action's services and feedback as rosidl makes them.
MESSAGES = Path(__file__).parents[3] / "packaging/ros/velomotion_msgs/action"
for name in ["Capture", "MoveTilt"]:
    goal, result, feedback = (MESSAGES / f"{name}.action").read_text().split("---\n")
    goal_id = "unique_identifier_msgs/UUID goal_id\n"
    for part, text in {
        "Goal": goal,
        "Result": result,
        "Feedback": feedback,
        "SendGoal_Request": f"{goal_id}{name}_Goal goal\n",
        "SendGoal_Response": "bool accepted\nbuiltin_interfaces/Time stamp\n",
        "GetResult_Request": goal_id,
        "GetResult_Response": f"int8 status\n{name}_Result result\n",
        "FeedbackMessage": f"{goal_id}{name}_Feedback feedback\n",
        "CancelGoal_Request": "action_msgs/GoalInfo goal_info\n",
        "CancelGoal_Response": "int8 return_code\naction_msgs/GoalInfo[] goals_canceling\n",
    }.items():
        store.register(get_types_from_msg(text, f"velomotion_msgs/msg/{name}_{part}"))
# Of the package rcl_interfaces.
PARAMETER = "rcl_interfaces/Parameter"
for name, (request, response) in {
    "DescribeParameters": ("string[] names", f"{PARAMETER}Descriptor[] descriptors"),
    "GetParameters": ("string[] names", f"{PARAMETER}Value[] values"),
    "GetParameterTypes": ("string[] names", "uint8[] types"),
    "ListParameters": ("string[] prefixes\nuint64 depth", "rcl_interfaces/ListParametersResult result"),
    "SetParameters": (f"{PARAMETER}[] parameters", "rcl_interfaces/SetParametersResult[] results"),
    "SetParametersAtomically": (f"{PARAMETER}[] parameters", "rcl_interfaces/SetParametersResult result"),
}.items():
    for part, text in {"Request": request, "Response": response}.items():
        store.register(get_types_from_msg(f"{text}\n", f"rcl_interfaces/msg/{name}_{part}"))
mouth = threading.Lock()
KINDS = {2: "u1", 4: "<u2", 7: "<f4", 8: "<f8"}


def say(**what):
    with mouth:
        print(json.dumps(what), flush=True)


def ros_name(dds):
    """sensor_msgs::msg::dds_::PointCloud2_ as ROS writes it."""
    package, kind, marker, name = dds.split("::")
    assert marker == "dds_" and name.endswith("_"), dds
    return f"{package}/{kind}/{name[:-1]}"


def attachment_of(sample):
    """As rmw_zenoh reads it; it drops what has none."""
    data = sample.attachment.to_bytes()
    assert len(data) == 33 and data[16] == 16, data
    number, sent = np.frombuffer(data[:16], "<i8")
    theirs = Attachment.from_bytes(data)
    assert (theirs.sequence_id, theirs.timestamp_ns, theirs.gid) == (number, sent, data[17:])
    return {"number": int(number), "sent_ns": int(sent), "gid": data[17:].hex()}


def nanoseconds(stamp):
    return stamp.sec * 10**9 + stamp.nanosec


def cloud(message):
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
    rows = np.frombuffer(bytes(message.data), kind)
    distance = np.sqrt(sum(rows[axis].astype("f8") ** 2 for axis in "xyz"))
    return {
        "stamp_ns": nanoseconds(message.header.stamp),
        "frame": message.header.frame_id,
        "points": message.width,
        "fields": list(kind.names),
        "last_s": float(rows["time"].max()),
        "first_s": float(rows["time"].min()),
        "farthest_m": float(distance.max()),
        "rings": int(rows["ring"].max()) + 1,
    }


def scan(message):
    """The azimuths of a driver's message rise from its first packet to its last."""
    azimuths = [int.from_bytes(bytes(packet.data[2:4]), "little") for packet in message.packets]
    return {
        "stamp_ns": nanoseconds(message.header.stamp),
        "frame": message.header.frame_id,
        "last_ns": nanoseconds(message.packets[-1].stamp),
        "packets": len(azimuths),
        "first_cdeg": azimuths[0],
        "last_cdeg": azimuths[-1],
        "rises": azimuths == sorted(azimuths),
    }


def plain(message):
    """A message of any type as JSON; arrays of bytes in hexadecimal, NaN as null."""
    if hasattr(message, "__msgtype__"):
        fields = [field for field, _ in store.fielddefs[message.__msgtype__][1]]
        return {field: plain(getattr(message, field)) for field in fields}
    if isinstance(message, np.ndarray):
        return message.tobytes().hex() if message.dtype == np.uint8 else message.tolist()
    if isinstance(message, list):
        return [plain(each) for each in message]
    if isinstance(message, float) and np.isnan(message):
        return None
    return message


def made(kind, values):
    """A message of a type from JSON, as ros2's command line makes them; absent fields are zero or empty."""
    fields = {}
    for field, (node, about) in store.fielddefs[kind][1]:
        value = values.get(field)
        if node == Nodetype.NAME:
            fields[field] = made(about, value or {})
        elif node == Nodetype.BASE:
            fields[field] = value or {"string": ""}.get(about[0], 0)
        elif about[0][0] == Nodetype.NAME:
            fields[field] = [made(about[0][1], each) for each in value or []]
        else:
            element = about[0][1][0]
            if element == "string":
                fields[field] = value or []
            elif node == Nodetype.ARRAY:
                fields[field] = np.frombuffer(bytes.fromhex(value or "00" * about[1]), element)
            else:
                fields[field] = np.array(value or [], element)
    return store.types[kind](**fields)


def transform(message):
    at = message.transform
    return {
        "stamp_ns": nanoseconds(message.header.stamp),
        "parent": message.header.frame_id,
        "child": message.child_frame_id,
        "translation": [at.translation.x, at.translation.y, at.translation.z],
        "rotation": [at.rotation.x, at.rotation.y, at.rotation.z, at.rotation.w],
    }


def content(name, message):
    if name == "action_msgs/msg/GoalStatusArray" or name.startswith("velomotion_msgs/"):
        return plain(message)
    if name == "sensor_msgs/msg/PointCloud2":
        return cloud(message)
    if name == SCAN:
        return scan(message)
    if name == "sensor_msgs/msg/JointState":
        return {
            "stamp_ns": nanoseconds(message.header.stamp),
            "name": list(message.name),
            "position": [float(value) for value in message.position],
            "others": len(message.velocity) + len(message.effort),
        }
    if name == "tf2_msgs/msg/TFMessage":
        return {"transforms": [transform(each) for each in message.transforms]}
    if name == "diagnostic_msgs/msg/DiagnosticArray":
        return {
            "stamp_ns": nanoseconds(message.header.stamp),
            "status": {
                status.name: {
                    "level": int(status.level),
                    "message": status.message,
                    "hardware": status.hardware_id,
                    "values": {value.key: value.value for value in status.values},
                }
                for status in message.status
            },
        }
    raise ValueError(name)


def listener(who, kind=None):
    def callback(sample):
        try:
            key = str(sample.key_expr)
            if kind is None:
                domain, *topic, dds, digest = key.split("/")
                name = ros_name(dds)
            else:
                # For a bridge to DDS the key is the topic's name.
                domain, topic, digest, name = None, key.split("/"), None, kind
            # The types of actions have other names in rosbags, and thus another hash.
            own = name.startswith("velomotion_msgs/") or kind is not None
            name = name.replace("/action/", "/msg/")
            # What a node with these types subscribes to; another hash is another topic.
            assert own or digest == store.hash_rihs01(name), f"{key}: {store.hash_rihs01(name)}"
            attachment = attachment_of(sample)
            payload = sample.payload.to_bytes()
            message = store.deserialize_cdr(payload, name)
            assert bytes(store.serialize_cdr(message, name)) == payload, key
            topic = "/" + "/".join(topic)
            if topic.endswith("/velomotion/points"):
                (folder / f"{who}-{attachment['number']}.cdr").write_bytes(payload)
            if name == SCAN:
                (folder / f"{who}-packets-{attachment['number']}.cdr").write_bytes(payload)
            say(
                received=topic,
                who=who,
                domain=domain,
                type=name,
                hash=digest,
                printed=content(name, message),
                **attachment,
            )
        except Exception as error:  # a callback's own errors go nowhere
            say(error=f"{type(error).__name__}: {error}", key=str(sample.key_expr))

    return callback


def call(session, key, attachment):
    """As a client of rmw_zenoh or the bridge to DDS calls: std_srvs/srv/Trigger's request is one byte that means nothing."""
    gid = bytes(range(16))
    sent = time.time_ns()
    data = None
    if attachment == "rmw_zenoh":
        data = np.array([7, sent], "<i8").tobytes() + bytes([16]) + gid
    elif attachment == "dds":
        gid = gid[:8] + bytes(8)
        data = b"rqh" + gid[:8] + np.array([7], "<i8").tobytes() + b"\x01"
    replies = session.get(
        key,
        payload=b"\x00\x01\x00\x00\x00",
        attachment=data,
        target=zenoh.QueryTarget.ALL_COMPLETE,
        consolidation=zenoh.ConsolidationMode.NONE,
        timeout=60.0,
    )
    for reply in replies:
        if reply.ok is None:
            say(refused=reply.err.payload.to_string(), key=key)
            continue
        answered = attachment_of(reply.ok)
        payload = reply.ok.payload.to_bytes()
        assert payload[:4] == b"\x00\x01\x00\x00"
        length = int.from_bytes(payload[8:12], "little")
        text = payload[12 : 12 + length]
        assert text[-1:] == b"\0" and len(payload) == 12 + length
        say(
            answered=key,
            success=bool(payload[4]),
            message=text[:-1].decode(),
            own=answered["number"] == 7 and answered["gid"] == gid.hex(),
            later=answered["sent_ns"] >= sent,
        )
    say(called=key)


def ask(session, key, kind, request):
    """Calls a service; its answer is printed when it comes."""
    payload = store.serialize_cdr(made(f"{kind}_Request", request), f"{kind}_Request")
    attachment = np.array([7, time.time_ns()], "<i8").tobytes() + bytes([16]) + bytes(range(16))

    def answered(reply):
        if reply.ok is None:
            say(refused=reply.err.payload.to_string(), key=key)
            return
        response = store.deserialize_cdr(reply.ok.payload.to_bytes(), f"{kind}_Response")
        say(answer=key, response=plain(response))

    session.get(
        key,
        answered,
        payload=bytes(payload),
        attachment=attachment,
        target=zenoh.QueryTarget.ALL_COMPLETE,
        consolidation=zenoh.ConsolidationMode.NONE,
        timeout=600.0,
    )


def graph(domain):
    """What zenoh_ros2_sdk, another implementation of rmw_zenoh's format, reads in the tokens."""
    host, port = endpoint.removeprefix("tcp/").split(":")
    where = {"domain_id": domain, "router_ip": host, "router_port": int(port), "timeout": 5.0}
    topics = {}
    for name, types in discovery.get_topic_names_and_types(**where):
        for info in discovery.get_topic_info(name, verbose=True, **where).publishers:
            quality = QosProfile.decode(info.qos)
            topics[name] = {
                "types": list(types),
                "node": f"{info.node_namespace.rstrip('/')}/{info.node_name.lstrip('/')}",
                "reliability": quality.reliability.name,
                "durability": quality.durability.name,
                "depth": quality.history_depth,
            }
    services = {
        name: list(types) for name, types in discovery.get_service_names_and_types(**where)
    }
    say(topics=topics, services=services)


config = zenoh.Config()
config.insert_json5("mode", json.dumps(mode))
config.insert_json5("scouting/multicast/enabled", "false")
where = "listen" if mode == "router" else "connect"
config.insert_json5(f"{where}/endpoints", json.dumps([endpoint]))
config.insert_json5("timestamping/enabled", "true")
with zenoh.open(config) as session:
    kept = []
    for tokens in ["@ros2_lv/**", "@/*/@ros2_lv/**"]:
        kept.append(
            session.liveliness().declare_subscriber(
                tokens,
                lambda sample: say(
                    token=str(sample.key_expr), there=sample.kind == zenoh.SampleKind.PUT
                ),
                history=True,
            )
        )
    say(ready=str(session.zid()))
    for line in sys.stdin:
        command = json.loads(line)
        if command["do"] == "subscribe":
            kept.append(session.declare_subscriber(command["key"], listener(command["who"], command.get("kind"))))
        elif command["do"] == "subscribe_latched":
            # What rmw_zenoh makes of a transient local, reliable subscription.
            kept.append(
                zenoh.ext.declare_advanced_subscriber(
                    session,
                    command["key"],
                    listener(command["who"], command.get("kind")),
                    history=zenoh.ext.HistoryConfig(detect_late_publishers=True, max_samples=1),
                    recovery=zenoh.ext.RecoveryConfig(heartbeat=True),
                    subscriber_detection=True,
                )
            )
        elif command["do"] == "call":
            call(session, command["key"], command["attachment"])
        elif command["do"] == "ask":
            ask(session, command["key"], command["kind"], command["request"])
        elif command["do"] == "graph":
            graph(command["domain"])
        say(done=command["do"])
