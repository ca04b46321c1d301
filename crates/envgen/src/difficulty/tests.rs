use std::f64::consts::{PI, TAU};

use glam::DVec2;

use super::*;
use crate::Provenance;
use crate::geometry::{Rect, Shape};
use crate::world::{Obstacle, ObstacleKind, Surface, SurfaceKind, Wall, WallKind};

/// Thickness of the walls around a hand-made world, in metres.
const WALL: f64 = 0.2;

fn rect(x0: f64, y0: f64, x1: f64, y1: f64) -> Shape {
    Shape::from_rect(Rect::new(DVec2::new(x0, y0), DVec2::new(x1, y1)))
}

/// A hall of a size between walls, with obstacles in it.
fn hall(width: f64, height: f64, start: Pose, obstacles: &[Shape]) -> World {
    let bounds = Rect::new(DVec2::splat(-WALL), DVec2::new(width + WALL, height + WALL));
    let mut world = World::new(Provenance::other("manual", serde_json::Value::Null), bounds);
    let (w, h) = (width, height);
    world.walls = [
        rect(-WALL, -WALL, w + WALL, 0.0),
        rect(-WALL, h, w + WALL, h + WALL),
        rect(-WALL, 0.0, 0.0, h),
        rect(w, 0.0, w + WALL, h),
    ]
    .map(|shape| Wall::new(WallKind::Wall, shape))
    .into();
    let obstacle = |shape: &Shape| Obstacle::new(ObstacleKind::Other, shape.clone());
    world.obstacles = obstacles.iter().map(obstacle).collect();
    world.start = Some(start);
    world
}

fn vector(world: &World) -> DifficultyVector {
    DifficultyVector::of(world, &Platform::default()).expect("a vector")
}

fn information(world: &World, platform: &Platform, pose: Pose) -> ScanInformation {
    let rays = Raycaster::new(world);
    let laser = Laser::new(&rays, platform).expect("a laser");
    View::new(&laser, pose).information
}

#[test]
fn scans_in_an_endless_corridor_slide_along_it() {
    let pose = Pose::new(50.0, 1.0, 0.0);
    let platform = Platform { laser_offset: 0.0, ..Default::default() };
    let found = information(&hall(100.0, 2.0, pose, &[]), &platform, pose);
    assert!(found.greatest > 50.0 && found.least == 0.0, "{found:?}");

    // A box in it fixes the position along it by as many beams as meet its front.
    let (front, half) = (3.0, 0.5);
    let crate_box = rect(50.0 + front, 1.0 - half, 54.0, 1.0 + half);
    let found = information(&hall(100.0, 2.0, pose, &[crate_box]), &platform, pose);
    let on_front = (0..181).filter(|beam| {
        let angle = PI * (f64::from(*beam) / 180.0 - 0.5);
        libm::tan(angle).abs() * front < half
    });
    assert!((found.least - on_front.count() as f64).abs() < 1e-9, "{found:?}");
}

#[test]
fn the_middle_of_a_square_room_fixes_both_directions_alike() {
    let pose = Pose::new(2.0, 2.0, 0.0);
    let laser = Platform { laser_offset: 0.0, ..Default::default() };
    // The first and the last beam look back together.
    let all_around = Platform { field_of_view: TAU, beams: 361, ..laser };
    let found = information(&hall(4.0, 4.0, pose, &[]), &all_around, pose);
    assert!((found.ratio() - 180.0 / 181.0).abs() < 0.01, "{found:?}");
    assert!((found.least - 180.0).abs() < 1.5, "{found:?}");
}

#[test]
fn what_is_seen_from_the_start_needs_no_tour() {
    let DifficultyVector { tour, drift, ground, .. } =
        vector(&hall(5.0, 5.0, Pose::new(2.5, 2.5, 0.0), &[]));
    assert_eq!((tour.tour_length_100_m, tour.tour_goals), (Some(0.0), 0));
    // It turns around, by a half at least, since its laser sees the other half.
    let turning = tour.tour_turning_100_rad.expect("it ends");
    assert!((PI..=TAU + 1e-9).contains(&turning), "{turning}");
    assert_eq!((tour.tour_dead_ends, tour.tour_dead_end_depth_max_m), (0, None));
    assert_eq!((tour.tour_seen_after_350_m_share, drift.drift_rate_m_per_root_m), (1.0, None));
    // But for the corners, into which a disc of 0.36 m does not reach.
    assert!((ground.ground_area_m2 - 25.0).abs() < 0.8, "{}", ground.ground_area_m2);
}

#[test]
fn a_corridor_is_driven_to_its_end() {
    let DifficultyVector { tour, clearance, .. } =
        vector(&hall(40.0, 2.0, Pose::new(8.0, 1.0, 0.0), &[]));
    // It sees 8.19 m from 0.21 m ahead: the near end from the start, the far one from as far away.
    let sight = 8.19 + 0.21 + 0.36;
    let expected = 40.0 - sight - 8.0;
    let length = tour.tour_length_100_m.expect("it ends");
    assert!((expected - 0.5..expected + 1.5).contains(&length), "{length} m, not {expected} m");
    assert!(tour.tour_length_80_m <= tour.tour_length_95_m);
    assert!(tour.tour_length_95_m < tour.tour_length_100_m);
    assert_eq!((tour.tour_dead_ends, tour.tour_dead_end_depth_mean_m), (0, None));
    // About the middle of the corridor.
    let slowed = clearance.tour_length_over_clearance;
    assert!((length..1.3 * length).contains(&slowed), "{slowed} over {length} m");
    assert!((clearance.clearance_90_m - 0.9).abs() < 0.11, "{}", clearance.clearance_90_m);
}

#[test]
fn who_starts_between_two_ends_drives_back() {
    let DifficultyVector { tour, .. } = vector(&hall(40.0, 2.0, Pose::new(12.0, 1.0, 0.0), &[]));
    let depth = tour.tour_dead_end_depth_max_m.expect("a dead end");
    assert!(tour.tour_dead_ends >= 1 && depth > 2.0, "{depth}");
    let length = tour.tour_length_100_m.expect("it ends");
    // From an end back to the start, and on to the other one.
    assert!(length > 40.0 - 2.0 * 8.76 + depth, "{length} with {depth}");
}

/// Two rooms of 5 m x 5 m with doors of some widths between them.
fn two_rooms(doors: &[f64]) -> World {
    let share = 5.0 / doors.len() as f64;
    let mut walls = Vec::new();
    for (i, width) in doors.iter().enumerate() {
        let (from, to) = (share * i as f64, share * (i + 1) as f64);
        let middle = 0.5 * (from + to);
        walls.push(rect(5.0, from, 5.1, middle - 0.5 * width));
        walls.push(rect(5.0, middle + 0.5 * width, 5.1, to));
    }
    hall(10.1, 5.0, Pose::new(2.0, 2.0, 0.0), &walls)
}

#[test]
fn rooms_and_doors_are_places_and_links() {
    for width in [0.74, 0.8, 0.94] {
        let DifficultyVector { clearance, places, .. } = vector(&two_rooms(&[width]));
        assert_eq!(clearance.pieces_at_0_5_m, 2, "{width} m");
        let narrowest = clearance.narrowest_passage_m.expect("a door");
        assert!((narrowest - width).abs() < 0.02, "{narrowest} m, not {width} m");
        assert_eq!(clearance.passage_width_mean_m, Some(narrowest));
        assert_eq!((places.places, places.place_links, places.place_cycles), (2, 1, 0));
        assert_eq!((places.place_leaves, places.place_degree_max, places.loops), (2, 1, 0));
        // From the middle of one room to that of the other, or from plateaus of 1.5 m near them.
        assert!((3.0..8.0).contains(&places.place_diameter_m), "{}", places.place_diameter_m);
    }
    // A door that is too narrow for the robot leaves one room.
    let alone = vector(&two_rooms(&[0.7]));
    assert_eq!((alone.places.places, alone.clearance.narrowest_passage_m), (1, None));
    assert!((alone.ground.ground_area_m2 - 25.0).abs() < 1.0);
}

#[test]
fn two_doors_are_a_cycle() {
    let DifficultyVector { places, .. } = vector(&two_rooms(&[0.94, 0.94]));
    assert_eq!((places.places, places.place_links, places.place_cycles), (2, 2, 1));
    assert_eq!(places.place_leaves, 0);
}

#[test]
fn a_ring_of_corridors_is_a_loop() {
    let block = rect(2.0, 2.0, 10.0, 10.0);
    let DifficultyVector { places, tour, .. } =
        vector(&hall(12.0, 12.0, Pose::new(1.0, 1.0, 0.0), &[block]));
    assert_eq!(places.loops, 1);
    // Around the block at the distance that the robot keeps.
    let expected = 32.0 + TAU * 0.36;
    let length = places.loop_length_mean_m.expect("a loop");
    assert!((length / expected - 1.0).abs() < 0.08, "{length} m, not {expected} m");
    assert_eq!(places.loop_length_max_m, Some(length));
    let tour = tour.tour_length_100_m.expect("it ends");
    assert!((15.0..40.0).contains(&tour), "{tour}");
}

#[test]
fn walls_are_measured_and_short_ones_are_counted() {
    let start = Pose::new(1.0, 1.0, 0.0);
    let DifficultyVector { walls: empty, .. } = vector(&hall(6.0, 4.0, start, &[]));
    assert!((empty.wall_length_m - 20.0).abs() < 1e-9, "{}", empty.wall_length_m);
    assert!((empty.longest_plain_run_over_range - 6.0 / 8.19).abs() < 1e-9);
    assert!((empty.plain_runs_m - 20.0).abs() < 1e-9 && empty.short_walls_per_m2 == 0.0);
    let crates =
        [rect(3.0, 2.0, 3.5, 2.5), Shape::Disc { center: DVec2::new(5.0, 2.0), radius: 0.1 }];
    let DifficultyVector { walls, ground, .. } = vector(&hall(6.0, 4.0, start, &crates));
    let round = TAU * 0.1;
    assert!((walls.wall_length_m - 22.0 - round).abs() < 1e-9, "{}", walls.wall_length_m);
    let short = walls.short_walls_per_m2 * ground.ground_area_m2;
    assert!((short - 5.0).abs() < 1e-9, "{short} short pieces");
    let plain = walls.plain_share.expect("walls");
    assert!((plain - 20.0 / (22.0 + round)).abs() < 1e-9, "{plain}");
}

#[test]
fn an_open_world_shows_nothing() {
    let bounds = Rect::new(DVec2::ZERO, DVec2::splat(30.0));
    let world = World::new(Provenance::other("manual", serde_json::Value::Null), bounds);
    let DifficultyVector { ground, localization, visibility, walls, drift, barn, .. } =
        vector(&world);
    assert!((ground.ground_area_m2 - 900.0).abs() < 1e-6, "{}", ground.ground_area_m2);
    assert_eq!((localization.scan_degeneracy, localization.scan_degenerate_share), (1.0, 1.0));
    assert_eq!(localization.scan_position_error_80_m, None);
    assert_eq!((visibility.echo_share, visibility.alias_share), (0.0, Some(1.0)));
    let half_disc = 0.5 * PI * 8.19 * 8.19;
    assert!((visibility.visible_area_mean_m2 / half_disc - 1.0).abs() < 1e-9);
    assert_eq!((walls.wall_length_m, walls.plain_share), (0.0, None));
    assert!(drift.drift_position_m > 0.1, "{}", drift.drift_position_m);
    assert_eq!(barn.barn_tour_closest_obstacle_m, None);
    assert_eq!(barn.barn_reference_tour_dispersion, Some(0.0));
}

#[test]
fn a_goal_straight_ahead_has_a_straight_path() {
    let mut world = hall(20.0, 3.0, Pose::new(1.5, 1.5, 0.0), &[]);
    world.goal = Some(Pose::new(18.5, 1.5, 0.0));
    let barn = vector(&world).barn;
    assert_eq!(barn.barn_goal_tortuosity, Some(1.0));
    // Along the middle; of the cells along the walls the first has no point where the robot can be.
    let closest = barn.barn_goal_closest_obstacle_m.expect("walls");
    assert!((closest - 1.4).abs() < 1e-9, "{closest}");
    let cells = barn.barn_reference_goal_closest_obstacle_cells.expect("walls");
    assert!((0.2 * cells - closest).abs() < 1e-9);
    world.goal = Some(Pose::new(18.5, 0.1, 0.0));
    assert_eq!(vector(&world).barn.barn_goal_tortuosity, None);
}

#[test]
fn water_is_not_driven_through() {
    let mut world = hall(12.0, 4.0, Pose::new(2.0, 2.0, 0.0), &[]);
    let whole = vector(&world).clearance.reachable_area_m2;
    let shape = rect(5.0, 0.0, 7.0, 4.0);
    let kind = SurfaceKind::Water;
    world.surfaces.push(Surface::new(kind, shape));
    let left = vector(&world).clearance.reachable_area_m2;
    assert!((left / whole - (5.0 - 0.36) / (12.0 - 0.72)).abs() < 0.03, "{left} of {whole} m^2");
}

#[test]
fn no_band_of_water_is_too_narrow_to_stop_a_robot() {
    let mut world = hall(12.0, 4.0, Pose::new(2.0, 2.0, 0.0), &[]);
    world.goal = Some(Pose::new(10.0, 2.0, 0.0));
    let whole = vector(&world).clearance.reachable_area_m2;
    for width in [0.01, 0.1, 0.2, 0.3] {
        // Off the middles of the cells.
        for x in [5.0, 5.03, 5.11, 5.18] {
            world.surfaces = vec![Surface::new(SurfaceKind::Water, rect(x, 0.0, x + width, 4.0))];
            let left = vector(&world);
            let share = left.clearance.reachable_area_m2 / whole;
            assert!(share < 0.5, "{share} of the hall before {width} m of water at {x} m");
        }
    }
}

/// Ground that covers all of a hall.
fn floor(width: f64, height: f64) -> Surface {
    Surface::new(SurfaceKind::Slippery, rect(0.0, 0.0, width, height))
}

#[test]
fn a_slippery_floor_doubles_the_drift_of_who_sees_nothing() {
    let mut world = open(40.0, 30.0);
    let before = vector(&world);
    assert_eq!(before.tour.tour_odometry_noise_mean, Some(1.0));
    world.surfaces.push(Surface { odometry_noise: 4.0, ..floor(40.0, 30.0) });
    let after = vector(&world);
    let noise = after.tour.tour_odometry_noise_mean.expect("it drives");
    assert!((noise - 4.0).abs() < 1e-9, "{noise}");
    for name in ["position_m", "heading_rad", "map_m", "worst_gap_m", "rate_m_per_root_m"] {
        let name = format!("drift_{name}");
        let (a, b) = (before.get(&name).expect("drift"), after.get(&name).expect("drift"));
        assert!((b / a - 2.0).abs() < 1e-9, "{name}: {a} and {b}");
    }
    let same = |vector: &DifficultyVector| (vector.visibility.clone(), vector.clearance.clone());
    assert_eq!(same(&before), same(&after));
}

#[test]
fn loose_floor_counts_where_the_tour_leads_over_it() {
    let start = Pose::new(2.0, 1.0, 0.0);
    let mut world = hall(60.0, 2.0, start, &[]);
    let plain = vector(&world);
    world.surfaces.push(Surface { wheel_bias: 0.2, ..floor(22.0, 2.0) });
    let loose = vector(&world);
    let length = loose.tour.tour_length_100_m.expect("it ends");
    assert_eq!(
        (plain.tour.tour_length_100_m, plain.tour.tour_wheel_bias_mean),
        (Some(length), Some(0.0))
    );
    // 20 of its metres are loose.
    let mean = loose.tour.tour_wheel_bias_mean.expect("it drives");
    assert!((mean * length - 0.2 * 20.0).abs() < 0.2 * 0.4, "{mean} over {length} m");
    assert!(loose.drift.drift_position_m > 1.5 * plain.drift.drift_position_m);
    assert_eq!(loose.drift.drift_heading_rad, plain.drift.drift_heading_rad);
}

#[test]
fn dark_walls_lose_beams_and_show_nothing_as_seen() {
    let start = Pose::new(5.0, 5.0, 0.0);
    let light = hall(10.0, 10.0, start, &[]);
    let mut dark = light.clone();
    dark.walls.iter_mut().for_each(|wall| wall.visible_range = Some(2.0));
    let (light, dark) = (vector(&light), vector(&dark));
    assert_eq!(light.visibility.lost_beam_share, 0.0);
    assert!(dark.visibility.lost_beam_share > 0.3, "{:?}", dark.visibility);
    // Walls beyond the greatest range are met by no beam: the others are as before.
    let met = |vector: &DifficultyVector| {
        vector.visibility.echo_share + vector.visibility.lost_beam_share
    };
    assert!((met(&light) - met(&dark)).abs() < 1e-12);
    let range = |vector: &DifficultyVector| vector.visibility.echo_range_mean_m.expect("echoes");
    assert!(range(&dark) <= 2.0 && range(&light) > 2.0);
    assert!(dark.visibility.visible_area_mean_m2 < light.visibility.visible_area_mean_m2);
    assert!(dark.localization.scan_degeneracy > light.localization.scan_degeneracy);
    assert!(dark.drift.drift_position_m > light.drift.drift_position_m);
    // From the middle it sees all of the light hall at once, and of the dark one next to nothing.
    assert_eq!(light.tour.tour_length_100_m, Some(0.0));
    assert!(dark.tour.tour_length_100_m.expect("it ends") > 10.0);
    assert_eq!((light.walls, light.places), (dark.walls, dark.places));

    // Seen from nearer than that, dark walls are as light ones.
    let mut near = hall(10.0, 10.0, start, &[]);
    near.walls.iter_mut().for_each(|wall| wall.visible_range = Some(9.0));
    assert_eq!(vector(&near), vector(&hall(10.0, 10.0, start, &[])));
}

#[test]
fn the_order_of_parts_does_not_matter() {
    let mut crates: Vec<Shape> = (0..12)
        .map(|i| {
            let center = DVec2::new(2.0 + 1.3 * f64::from(i % 4), 2.2 + 1.7 * f64::from(i / 4));
            Shape::Box { center, half_size: DVec2::new(0.3, 0.2), heading: 0.4 * f64::from(i) }
        })
        .collect();
    let start = Pose::new(0.7, 0.7, 0.3);
    let before = vector(&hall(8.0, 8.0, start, &crates)).values();
    crates.reverse();
    let after = vector(&hall(8.0, 8.0, start, &crates)).values();
    for ((a, b), feature) in before.into_iter().zip(after).zip(DifficultyVector::features()) {
        let same = match (a, b) {
            (Some(a), Some(b)) => (a - b).abs() <= 1e-9 * (1.0 + a.abs()),
            (a, b) => a == b,
        };
        assert!(same, "{}: {a:?} and {b:?}", feature.name);
    }
}

#[test]
fn names_carry_units_and_are_those_of_the_file() {
    let features = DifficultyVector::features();
    let found = vector(&hall(5.0, 5.0, Pose::new(2.5, 2.5, 0.0), &[]));
    let json = serde_json::to_value(&found).expect("JSON");
    let fields = json.as_object().expect("an object");
    assert_eq!((fields.len(), found.values().len()), (features.len(), features.len()));
    for (feature, value) in features.iter().zip(found.values()) {
        let ending = match feature.unit {
            "m" | "cells" | "rad" | "1/m" | "1/m^2" | "m^2" => {
                feature.unit.replace("1/", "per_").replace('^', "")
            }
            "m/m^0.5" => "m_per_root_m".to_owned(),
            "m/m" => "m_per_m".to_owned(),
            "rad/m" => "rad_per_m".to_owned(),
            _ => String::new(),
        };
        assert!(feature.name.ends_with(&ending), "{} in {}", feature.name, feature.unit);
        assert_eq!(fields[feature.name].as_f64(), value, "{}", feature.name);
        assert_eq!(found.get(feature.name), value, "{}", feature.name);
        assert!(!feature.help.is_empty() && !feature.help.ends_with('.'), "{}", feature.help);
    }
    assert_eq!(found.get("beauty"), None);
}

#[test]
fn robots_that_fit_nowhere_are_errors() {
    let world = hall(5.0, 5.0, Pose::new(0.2, 2.5, 0.0), &[]);
    let error = DifficultyVector::of(&world, &Platform::default()).expect_err("in the wall");
    assert_eq!(
        error.to_string(),
        "`start` must be on ground to drive on with 0.36 m of free ground all around, got (0.2, 2.5) m"
    );
    let mut narrow = hall(5.0, 0.6, Pose::new(2.0, 0.3, 0.0), &[]);
    narrow.start = None;
    let error = DifficultyVector::of(&narrow, &Platform::default()).expect_err("no ground");
    assert_eq!(error, DifficultyError::NoGround { radius: 0.36 });
    let small = Platform { circumscribed_radius: 0.1, laser_offset: 0.0, ..Default::default() };
    assert!(DifficultyVector::of(&narrow, &small).is_ok());
    let wrong = Platform { max_range: f64::NAN, ..Default::default() };
    let error = DifficultyVector::of(&world, &wrong).expect_err("no laser").to_string();
    assert_eq!(error, "`platform.max_range` must be a number from 0.1 to 200, got NaN");
    let mut broken = world;
    broken.bounds.max.x = f64::INFINITY;
    let error = DifficultyVector::of(&broken, &Platform::default());
    assert!(matches!(error, Err(DifficultyError::World(_))), "{error:?}");
}

#[test]
fn huge_worlds_have_larger_cells() {
    for (width, height) in [(2000.0, 2000.0), (1e6, 1.0)] {
        let bounds = Rect::new(DVec2::ZERO, DVec2::new(width, height));
        let world = World::new(Provenance::other("manual", serde_json::Value::Null), bounds);
        let space = Space::new(&world, 0.36).expect("a space");
        assert!(space.frame.len() <= MAX_CELLS && space.frame.cell_size > CELL);
        assert_eq!(space.count, space.frame.len());
    }
}

/// A world of a size without walls around it, from the origin on.
fn open(width: f64, height: f64) -> World {
    let bounds = Rect::new(DVec2::ZERO, DVec2::new(width, height));
    World::new(Provenance::other("manual", serde_json::Value::Null), bounds)
}
