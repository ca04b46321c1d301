//! The questions of the form, in its own words.

/// The form's title.
pub const TITLE: &str = "Robot Mapping Feedback Form";

/// The operator's name.
pub const NAME: &str = "Name";

/// The operator's experience.
pub const EXPERIENCE: &str = "Experience level as operator";

/// The environment that was mapped.
pub const ENVIRONMENT: &str = "Name of the map/environment";

/// The software that ran the simulation.
pub const SOFTWARE: &str = "Software used for the mapping";

/// How robots and operator were connected.
pub const CONNECTION: &str = "Connection";

/// The robots.
pub const ROBOTS: &str = "Number and type of robots";

/// The single rating of the original form.
pub const DIFFICULTY: &str =
    "Overall, how would you rate the difficulty of the environment in terms of mapping?";

/// What the lower end of the rating means.
pub const DIFFICULTY_0: &str = "0: nothing in it 'forces' a mapping error on the robot";

/// What the upper end of the rating means.
pub const DIFFICULTY_10: &str =
    "10: the map cannot be properly navigated, due to excessive mapping errors";

/// Mapping alone, which is not in the original form.
pub const MAPPING: &str = "How difficult was it to map?";

/// Getting around alone, which is not in the original form.
pub const GETTING_AROUND: &str = "How difficult was it to get around?";

/// What made it difficult.
pub const CONTRIBUTED: &str = "What aspects of the map contributed most to the difficulty?";

/// Rooms that were difficult.
pub const DIFFICULT_ROOMS: &str =
    "Were there rooms that were particularly difficult to map, and why?";

/// Rooms that were easy.
pub const EASY_ROOMS: &str = "Were there rooms that were particularly easy to map, and why?";

/// Patterns of the layout.
pub const PATTERNS: &str = "What patterns did you notice in the layout (hallways, dead ends, \
                            doorways), and what effect did each have on the difficulty?";

/// Anything else.
pub const OTHER: &str = "Is there anything else that stood out?";
