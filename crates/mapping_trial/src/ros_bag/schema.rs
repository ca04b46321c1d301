//! The definitions of the messages, as in ROS 2's `common_interfaces`, `rcl_interfaces` and `geometry2`.

/// The types of messages in a bag.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum MessageType {
    LaserScan,
    Odometry,
    TfMessage,
    OccupancyGrid,
    PoseStamped,
    Clock,
}

/// A line that separates a definition from the next one that it depends on.
const SEPARATOR: &str =
    "================================================================================\n";

const TIME: (&str, &str) = ("builtin_interfaces/Time", "int32 sec\nuint32 nanosec\n");
const HEADER: (&str, &str) =
    ("std_msgs/Header", "builtin_interfaces/Time stamp\nstring frame_id\n");
const POINT: (&str, &str) = ("geometry_msgs/Point", "float64 x\nfloat64 y\nfloat64 z\n");
const VECTOR: (&str, &str) = ("geometry_msgs/Vector3", "float64 x\nfloat64 y\nfloat64 z\n");
const QUATERNION: (&str, &str) =
    ("geometry_msgs/Quaternion", "float64 x 0\nfloat64 y 0\nfloat64 z 0\nfloat64 w 1\n");
const POSE: (&str, &str) =
    ("geometry_msgs/Pose", "geometry_msgs/Point position\ngeometry_msgs/Quaternion orientation\n");
const POSE_WITH_COVARIANCE: (&str, &str) =
    ("geometry_msgs/PoseWithCovariance", "geometry_msgs/Pose pose\nfloat64[36] covariance\n");
const TWIST: (&str, &str) =
    ("geometry_msgs/Twist", "geometry_msgs/Vector3 linear\ngeometry_msgs/Vector3 angular\n");
const TWIST_WITH_COVARIANCE: (&str, &str) =
    ("geometry_msgs/TwistWithCovariance", "geometry_msgs/Twist twist\nfloat64[36] covariance\n");
const TRANSFORM: (&str, &str) = (
    "geometry_msgs/Transform",
    "geometry_msgs/Vector3 translation\ngeometry_msgs/Quaternion rotation\n",
);
const TRANSFORM_STAMPED: (&str, &str) = (
    "geometry_msgs/TransformStamped",
    "std_msgs/Header header\nstring child_frame_id\ngeometry_msgs/Transform transform\n",
);
const MAP_META_DATA: (&str, &str) = (
    "nav_msgs/MapMetaData",
    "builtin_interfaces/Time map_load_time\nfloat32 resolution\nuint32 width\nuint32 height\n\
     geometry_msgs/Pose origin\n",
);

impl MessageType {
    /// All types of messages.
    #[cfg(test)]
    const ALL: [MessageType; 6] = [
        MessageType::LaserScan,
        MessageType::Odometry,
        MessageType::TfMessage,
        MessageType::OccupancyGrid,
        MessageType::PoseStamped,
        MessageType::Clock,
    ];

    /// Returns its name in ROS.
    pub(super) fn name(self) -> &'static str {
        match self {
            MessageType::LaserScan => "sensor_msgs/msg/LaserScan",
            MessageType::Odometry => "nav_msgs/msg/Odometry",
            MessageType::TfMessage => "tf2_msgs/msg/TFMessage",
            MessageType::OccupancyGrid => "nav_msgs/msg/OccupancyGrid",
            MessageType::PoseStamped => "geometry_msgs/msg/PoseStamped",
            MessageType::Clock => "rosgraph_msgs/msg/Clock",
        }
    }

    /// Returns its definition, and the definitions of the types in it.
    fn definition(self) -> (&'static str, &'static [(&'static str, &'static str)]) {
        match self {
            MessageType::LaserScan => (
                "std_msgs/Header header\nfloat32 angle_min\nfloat32 angle_max\nfloat32 angle_increment\n\
                 float32 time_increment\nfloat32 scan_time\nfloat32 range_min\nfloat32 range_max\n\
                 float32[] ranges\nfloat32[] intensities\n",
                &[HEADER, TIME],
            ),
            MessageType::Odometry => (
                "std_msgs/Header header\nstring child_frame_id\ngeometry_msgs/PoseWithCovariance pose\n\
                 geometry_msgs/TwistWithCovariance twist\n",
                &[
                    HEADER,
                    TIME,
                    POSE_WITH_COVARIANCE,
                    POSE,
                    POINT,
                    QUATERNION,
                    TWIST_WITH_COVARIANCE,
                    TWIST,
                    VECTOR,
                ],
            ),
            MessageType::TfMessage => (
                "geometry_msgs/TransformStamped[] transforms\n",
                &[TRANSFORM_STAMPED, HEADER, TIME, TRANSFORM, VECTOR, QUATERNION],
            ),
            MessageType::OccupancyGrid => (
                "std_msgs/Header header\nnav_msgs/MapMetaData info\nint8[] data\n",
                &[HEADER, TIME, MAP_META_DATA, POSE, POINT, QUATERNION],
            ),
            MessageType::PoseStamped => (
                "std_msgs/Header header\ngeometry_msgs/Pose pose\n",
                &[HEADER, TIME, POSE, POINT, QUATERNION],
            ),
            MessageType::Clock => ("builtin_interfaces/Time clock\n", &[TIME]),
        }
    }

    /// Returns the text in the schema encoding `ros2msg`: the definition, and those that it depends on
    /// after separators.
    pub(super) fn text(self) -> String {
        let (text, needed) = self.definition();
        let mut text = text.to_owned();
        for (name, definition) in needed {
            text += &format!("{SEPARATOR}MSG: {name}\n{definition}");
        }
        text
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_type_in_a_definition_is_defined_once() {
        let basic = ["int8", "int32", "uint32", "float32", "float64", "string"];
        for of in MessageType::ALL {
            let text = of.text();
            let defined: Vec<&str> =
                text.lines().filter_map(|line| line.strip_prefix("MSG: ")).collect();
            let fields =
                text.lines().filter(|line| !line.starts_with("===") && !line.starts_with("MSG: "));
            let mut needed = Vec::new();
            for line in fields {
                let (kind, name) = line.split_once(' ').expect("a type and a name");
                let kind = kind.split('[').next().expect("a type");
                assert!(!name.is_empty());
                assert!(basic.contains(&kind) || defined.contains(&kind), "{of:?}: {line}");
                needed.push(kind);
            }
            for (i, name) in defined.iter().enumerate() {
                assert!(needed.contains(name), "{of:?}: {name} is not needed");
                assert!(!defined[..i].contains(name), "{of:?}: {name} is defined twice");
            }
            assert!(text.lines().filter(|line| line.starts_with('=')).all(|line| line.len() == 80));
        }
    }
}
