//! `metadata.yaml`, which rosbag2 keeps beside the file of a bag, with the quality of service of its
//! topics.

use std::fmt::Write;

use super::mcap::Totals;
use super::schema::MessageType;

/// Version of the layout: that of ROS 2 Humble, which later versions read.
const VERSION: u32 = 5;

/// How a topic was published, which matters when it is replayed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Publishing {
    /// Each message matters when it comes.
    Stream,
    /// The last message is kept for later subscribers: `transient_local`.
    Latched,
}

impl Publishing {
    /// Returns the profile as rosbag2 writes it, with the numbers of `rmw/types.h`.
    pub(super) fn qos(self) -> String {
        let (depth, durability) = match self {
            Publishing::Stream => (10, 2),
            Publishing::Latched => (1, 1),
        };
        let forever = "    sec: 9223372036\n    nsec: 854775807\n";
        format!(
            "- history: 1\n  depth: {depth}\n  reliability: 1\n  durability: {durability}\n  deadline:\n\
             {forever}  lifespan:\n{forever}  liveliness: 1\n  liveliness_lease_duration:\n{forever}  \
             avoid_ros_namespace_conventions: false\n"
        )
    }
}

/// A topic of a bag.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Topic {
    pub(super) name: String,
    pub(super) of: MessageType,
    pub(super) publishing: Publishing,
}

/// Returns the text of `metadata.yaml` for a bag of one file.
pub(super) fn metadata(file: &str, topics: &[Topic], totals: &Totals) -> String {
    // JSON strings are valid in YAML.
    let quoted = |text: &str| serde_json::Value::from(text).to_string();
    let (first, last) = totals.times.unwrap_or((0, 0));
    let (duration, messages) = (last - first, totals.messages());
    let file = quoted(file);
    let mut text = format!(
        "rosbag2_bagfile_information:\n  version: {VERSION}\n  storage_identifier: mcap\n  duration:\n    \
         nanoseconds: {duration}\n  starting_time:\n    nanoseconds_since_epoch: {first}\n  \
         message_count: {messages}\n  topics_with_message_count:\n"
    );
    for (topic, count) in topics.iter().zip(&totals.channels) {
        // Writing to a string does not fail.
        let _ = write!(
            text,
            "    - topic_metadata:\n        name: {}\n        type: {}\n        serialization_format: \
             cdr\n        offered_qos_profiles: {}\n      message_count: {count}\n",
            topic.name,
            topic.of.name(),
            quoted(&topic.publishing.qos()),
        );
    }
    text + &format!(
        "  compression_format: \"\"\n  compression_mode: \"\"\n  relative_file_paths:\n    - {file}\n  \
         files:\n    - path: {file}\n      starting_time:\n        nanoseconds_since_epoch: {first}\n      \
         duration:\n        nanoseconds: {duration}\n      message_count: {messages}\n"
    )
}
