"""A ROS 2 node over DDS, of PyPI's cyclonedds: node.py DOMAIN FOLDER

Subscribes to the daemon's topics, calls its service start_capture, sends a goal to its action move_tilt, and writes the clouds that
arrive to FOLDER. Prints what it saw, a JSON object.
"""

import json
import sys
import time
from pathlib import Path

from cyclonedds.core import Policy, Qos
from cyclonedds.domain import DomainParticipant
from cyclonedds.idl import make_idl_struct
from cyclonedds.idl.types import array, float32, float64, int32, int64, int8, sequence, uint8, uint32, uint64
from cyclonedds.pub import DataWriter
from cyclonedds.sub import DataReader
from cyclonedds.topic import Topic
from cyclonedds.util import duration

domain, folder = int(sys.argv[1]), Path(sys.argv[2])


def message(name):
    """A message of ROS as DDS names it."""
    package, kind, name = name.split("/")
    return lambda fields: make_idl_struct(name, f"{package}::{kind}::dds_::{name}_", fields.__annotations__)


@message("builtin_interfaces/msg/Time")
class Time:
    sec: int32
    nanosec: uint32


@message("std_msgs/msg/Header")
class Header:
    stamp: Time
    frame_id: str


@message("sensor_msgs/msg/PointField")
class PointField:
    name: str
    offset: uint32
    datatype: uint8
    count: uint32


@message("sensor_msgs/msg/PointCloud2")
class PointCloud2:
    header: Header
    height: uint32
    width: uint32
    fields: sequence[PointField]
    is_bigendian: bool
    point_step: uint32
    row_step: uint32
    data: sequence[uint8]
    is_dense: bool


@message("sensor_msgs/msg/JointState")
class JointState:
    header: Header
    name: sequence[str]
    position: sequence[float64]
    velocity: sequence[float64]
    effort: sequence[float64]


@message("geometry_msgs/msg/Transform")
class Transform:
    translation: array[float64, 3]
    rotation: array[float64, 4]


@message("geometry_msgs/msg/TransformStamped")
class TransformStamped:
    header: Header
    child_frame_id: str
    transform: Transform


@message("tf2_msgs/msg/TFMessage")
class TFMessage:
    transforms: sequence[TransformStamped]


# Services: rmw_cyclonedds puts the client and the number of the request before the message.
@message("std_srvs/srv/Trigger_Request")
class TriggerRequest:
    client: uint64
    number: int64
    structure_needs_at_least_one_member: uint8


@message("std_srvs/srv/Trigger_Response")
class TriggerResponse:
    client: uint64
    number: int64
    success: bool
    message: str


@message("velomotion_msgs/action/MoveTilt_Goal")
class Goal:
    home: bool
    to_deg: sequence[float64, 1]
    speed_deg_s: sequence[float64, 1]


@message("velomotion_msgs/action/MoveTilt_SendGoal_Request")
class SendGoalRequest:
    client: uint64
    number: int64
    goal_id: array[uint8, 16]
    goal: Goal


@message("velomotion_msgs/action/MoveTilt_SendGoal_Response")
class SendGoalResponse:
    client: uint64
    number: int64
    accepted: bool
    stamp: Time


@message("velomotion_msgs/action/MoveTilt_GetResult_Request")
class GetResultRequest:
    client: uint64
    number: int64
    goal_id: array[uint8, 16]


@message("velomotion_msgs/action/MoveTilt_Result")
class Result:
    angle_deg: float64
    message: str


@message("velomotion_msgs/action/MoveTilt_GetResult_Response")
class GetResultResponse:
    client: uint64
    number: int64
    status: int8
    result: Result


@message("velomotion_msgs/action/MoveTilt_FeedbackMessage")
class Feedback:
    goal_id: array[uint8, 16]
    angle_deg: float64
    left_s: float64


@message("action_msgs/msg/GoalInfo")
class GoalInfo:
    goal_id: array[uint8, 16]
    stamp: Time


@message("action_msgs/msg/GoalStatus")
class GoalStatus:
    goal_info: GoalInfo
    status: int8


@message("action_msgs/msg/GoalStatusArray")
class GoalStatusArray:
    status_list: sequence[GoalStatus]


@message("action_msgs/srv/CancelGoal_Request")
class CancelGoalRequest:
    client: uint64
    number: int64
    goal_info: GoalInfo


@message("action_msgs/srv/CancelGoal_Response")
class CancelGoalResponse:
    client: uint64
    number: int64
    return_code: int8
    goals_canceling: sequence[GoalInfo]


# The graph of ROS.
@message("rmw_dds_common/msg/Gid")
class Gid:
    data: array[uint8, 16]


@message("rmw_dds_common/msg/NodeEntitiesInfo")
class NodeEntitiesInfo:
    node_namespace: str
    node_name: str
    reader_gid_seq: sequence[Gid]
    writer_gid_seq: sequence[Gid]


@message("rmw_dds_common/msg/ParticipantEntitiesInfo")
class ParticipantEntitiesInfo:
    gid: Gid
    node_entities_info_seq: sequence[NodeEntitiesInfo]


def quality(reliable=True, latched=False, depth=10):
    return Qos(
        Policy.Reliability.Reliable(duration(seconds=1)) if reliable else Policy.Reliability.BestEffort,
        Policy.Durability.TransientLocal if latched else Policy.Durability.Volatile,
        Policy.History.KeepLast(depth),
        Policy.DataRepresentation(use_cdrv0_representation=True),
    )


participant = DomainParticipant(domain)
readers, writers = [], []


def gid(entity):
    return Gid(data=list(entity.guid.bytes))


def reader(topic, kind, **qos):
    made = DataReader(participant, Topic(participant, topic, kind), qos=quality(**qos))
    readers.append(made)
    return made


def writer(topic, kind, **qos):
    made = DataWriter(participant, Topic(participant, topic, kind), qos=quality(**qos))
    writers.append(made)
    return made


def service(name, request, response):
    return writer(f"rq/{name}Request", request), reader(f"rr/{name}Reply", response)


static = reader("rt/tf_static", TFMessage, latched=True, depth=1)
joints = reader("rt/joint_states", JointState)
points = reader("rt/velomotion/points", PointCloud2)
live = reader("rt/velomotion/live_points", PointCloud2, reliable=False, depth=5)
trigger = service("velomotion/start_capture", TriggerRequest, TriggerResponse)
action = "velomotion/move_tilt/_action"
send_goal = service(f"{action}/send_goal", SendGoalRequest, SendGoalResponse)
get_result = service(f"{action}/get_result", GetResultRequest, GetResultResponse)
cancel_goal = service(f"{action}/cancel_goal", CancelGoalRequest, CancelGoalResponse)
feedback = reader(f"rt/{action}/feedback", Feedback)
status = reader(f"rt/{action}/status", GoalStatusArray, latched=True, depth=1)
graph = DataWriter(
    participant, Topic(participant, "ros_discovery_info", ParticipantEntitiesInfo), qos=quality(latched=True, depth=1)
)
node = NodeEntitiesInfo("/", "listener", [gid(entity) for entity in readers], [gid(entity) for entity in writers])
graph.write(ParticipantEntitiesInfo(gid(participant), [node]))


def until(what, condition, seconds=60):
    """Waits for a condition that is not false, and returns it."""
    end = time.monotonic() + seconds
    while not (value := condition()):
        if time.monotonic() > end:
            raise SystemExit(f"{what}: nothing after {seconds} s")
        time.sleep(0.05)
    return value


def call(parts, request):
    """Calls a service, once its server is there."""
    request_writer, response_reader = parts
    until("a server", request_writer.get_matched_subscriptions)
    until("a server's answers", response_reader.get_matched_publications)
    request_writer.write(request)
    (response,) = until("an answer", response_reader.take)
    assert (response.client, response.number) == (request.client, request.number), response
    return response


seen = {}
(frames,) = until("/tf_static", static.take)
seen["frames"] = sorted(transform.child_frame_id for transform in frames.transforms)
goal_id = list(range(16))
answer = call(send_goal, SendGoalRequest(7, 1, goal_id, Goal(True, [], [])))
seen["accepted"] = answer.accepted
result = call(get_result, GetResultRequest(7, 2, goal_id))
seen["goal"] = [result.status, round(result.result.angle_deg, 2), result.result.message]
seen["joint"] = until("/joint_states", joints.take)[-1].name
seen["feedback"] = len(feedback.take(1000)) > 0
seen["status"] = until("states", status.take)[-1].status_list[-1].status
answer = call(trigger, TriggerRequest(9, 1, 0))
seen["capture"] = [answer.success, answer.message]
seen["live"] = sum(cloud.width for cloud in until("live points", live.take)) > 0
cloud = until("the cloud", points.take)[0]
(folder / "cloud.bin").write_bytes(bytes(cloud.data))
seen["cloud"] = [cloud.header.frame_id, cloud.width * cloud.height, cloud.point_step]
print(json.dumps(seen))
