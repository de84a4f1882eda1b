//! The messages' definitions as recordings carry them (`ros2msg`): a message, then everything that
//! it is made of, each behind a line of 80 equals signs. As in ROS 2's `common_interfaces`,
//! `rcl_interfaces`, `geometry2` and `velodyne`, without their comments.

macro_rules! part {
    ($name:literal, $text:literal) => {
        concat!(
            "================================================================================\nMSG: ",
            $name,
            "\n",
            $text
        )
    };
}

macro_rules! header {
    () => {
        concat!(
            part!(
                "std_msgs/Header",
                "builtin_interfaces/Time stamp\nstring frame_id\n"
            ),
            part!("builtin_interfaces/Time", "int32 sec\nuint32 nanosec\n")
        )
    };
}

pub(super) const POINT_CLOUD2: &str = concat!(
    "std_msgs/Header header\nuint32 height\nuint32 width\nPointField[] fields\nbool is_bigendian\nuint32 point_step\nuint32 row_step\n\
     uint8[] data\nbool is_dense\n",
    part!(
        "sensor_msgs/PointField",
        "uint8 INT8=1\nuint8 UINT8=2\nuint8 INT16=3\nuint8 UINT16=4\nuint8 INT32=5\nuint8 UINT32=6\nuint8 FLOAT32=7\nuint8 FLOAT64=8\n\
         string name\nuint32 offset\nuint8 datatype\nuint32 count\n"
    ),
    header!()
);

pub(super) const VELODYNE_SCAN: &str = concat!(
    "std_msgs/Header header\nVelodynePacket[] packets\n",
    part!(
        "velodyne_msgs/VelodynePacket",
        "builtin_interfaces/Time stamp\nuint8[1206] data\n"
    ),
    header!()
);

pub(super) const GOAL_STATUS_ARRAY: &str = concat!(
    "GoalStatus[] status_list\n",
    part!(
        "action_msgs/GoalStatus",
        "GoalInfo goal_info\nint8 status\n"
    ),
    part!(
        "action_msgs/GoalInfo",
        "unique_identifier_msgs/UUID goal_id\nbuiltin_interfaces/Time stamp\n"
    ),
    part!("unique_identifier_msgs/UUID", "uint8[16] uuid\n"),
    part!("builtin_interfaces/Time", "int32 sec\nuint32 nanosec\n")
);

pub(super) const JOINT_STATE: &str = concat!(
    "std_msgs/Header header\nstring[] name\nfloat64[] position\nfloat64[] velocity\nfloat64[] effort\n",
    header!()
);

pub(super) const TF_MESSAGE: &str = concat!(
    "geometry_msgs/TransformStamped[] transforms\n",
    part!(
        "geometry_msgs/TransformStamped",
        "std_msgs/Header header\nstring child_frame_id\nTransform transform\n"
    ),
    part!(
        "geometry_msgs/Transform",
        "Vector3 translation\nQuaternion rotation\n"
    ),
    part!("geometry_msgs/Vector3", "float64 x\nfloat64 y\nfloat64 z\n"),
    part!(
        "geometry_msgs/Quaternion",
        "float64 x 0\nfloat64 y 0\nfloat64 z 0\nfloat64 w 1\n"
    ),
    header!()
);

pub(super) const DIAGNOSTIC_ARRAY: &str = concat!(
    "std_msgs/Header header\nDiagnosticStatus[] status\n",
    part!(
        "diagnostic_msgs/DiagnosticStatus",
        "byte OK=0\nbyte WARN=1\nbyte ERROR=2\nbyte STALE=3\nbyte level\nstring name\nstring message\nstring hardware_id\nKeyValue[] values\n"
    ),
    part!("diagnostic_msgs/KeyValue", "string key\nstring value\n"),
    header!()
);
