//! The room files that are built into the crate.

macro_rules! room {
    ($name:literal) => {
        ($name, include_str!(concat!("../../../assets/rooms/", $name, ".room.ron")))
    };
}

/// The name and the text of each file.
pub(super) const FILES: &[(&str, &str)] = &[
    room!("dark"),
    room!("empty"),
    room!("bisquare"),
    room!("victims"),
    room!("maze"),
    room!("futuristic_reception"),
    room!("warehouse"),
    room!("maze_smaller"),
    room!("computer_lab"),
    room!("single_office"),
    room!("dragon_room"),
    room!("multi_office"),
    room!("cubicle_unlit"),
    room!("boiler_room"),
    room!("single_office_north_destroyed"),
    room!("multi_office_tight_unlit_destroyed"),
    room!("computer_lab_unlit_destroyed"),
    room!("cubicle_unlit_destroyed"),
    room!("water_room"),
    room!("maze2"),
];
