use envgen::Spec;
use envgen::geometry::Pose;
use envgen::world::World;
use glam::DVec2;
use proptest::prelude::*;

use super::*;
use crate::map::{CLAMP, Cell, CellIndex, OccupancyMap, TILE};
use crate::mappable_area::tests::{add_wall, room};
use crate::robot::Robot;

fn truth(world: &World) -> Reference {
    Reference::new(world, &Robot::default()).expect("a world with free space")
}

/// Two rooms and a corridor between them.
fn flat() -> World {
    let mut world = room(16.0, 8.0);
    add_wall(&mut world, (5.0, 0.0), (5.1, 3.0));
    add_wall(&mut world, (5.0, 4.5), (5.1, 8.0));
    add_wall(&mut world, (5.1, 2.9), (11.0, 3.0));
    add_wall(&mut world, (5.1, 4.5), (11.0, 4.6));
    add_wall(&mut world, (11.0, 0.0), (11.1, 3.0));
    add_wall(&mut world, (11.0, 4.5), (11.1, 8.0));
    world
}

/// A run that made a map without moving.
pub(super) fn run(map: &OccupancyMap) -> RunSummary<'_> {
    RunSummary {
        map,
        tracks: &[],
        time: 0.0,
        time_limit: 1200.0,
        distance: 0.0,
        turning: 0.0,
        collisions: 0,
        moving: None,
        recoveries: 0,
        stuck: 0,
        energy_left: 1200.0,
    }
}

fn scores(truth: &Reference, map: &OccupancyMap) -> Scores {
    Scores::of(truth, &run(map)).expect("a sound run")
}

/// The known cells of a map.
fn known(map: &OccupancyMap) -> Vec<(CellIndex, i16)> {
    let mut cells = Vec::new();
    for ((col, row), tile) in map.tiles() {
        for (i, &odds) in tile.iter().enumerate().filter(|(_, odds)| **odds != 0) {
            let i = i as i32;
            cells
                .push((CellIndex { col: col * TILE + i % TILE, row: row * TILE + i / TILE }, odds));
        }
    }
    cells
}

/// A map with its cells moved; with `keep` only the occupied ones, added to the others.
fn moved(map: &OccupancyMap, by: (i32, i32), keep: bool) -> OccupancyMap {
    let mut result = if keep { map.clone() } else { OccupancyMap::new() };
    for (cell, odds) in known(map) {
        if !keep || odds > 0 {
            let cell = CellIndex { col: cell.col + by.0, row: cell.row + by.1 };
            result.add(cell, odds);
            result.add(cell, odds);
        }
    }
    announced(result)
}

/// A map after its changes were announced.
fn announced(mut map: OccupancyMap) -> OccupancyMap {
    map.bounds().into_iter().for_each(|bounds| map.touch(bounds));
    map
}

#[test]
fn the_identical_map_has_no_mapping_difficulty() {
    let mut worlds = vec![room(20.0, 20.0), flat()];
    for difficulty in [1.0, 9.0] {
        let spec = envgen::indoor::IndoorSpec { difficulty, ..Default::default() };
        worlds.push(envgen::Blueprint::to_world(&spec.generate(envgen::Seed(3)).expect("a map")));
    }
    for world in worlds {
        let truth = truth(&world);
        let map = truth.perfect_map();
        let poses = [Pose::new(1.0, 2.0, 0.5), Pose::new(1.5, 2.0, 0.5)];
        let tracks = [TrajectoryPair { truth: &poses, estimated: &poses }];
        let found = Scores::of(&truth, &RunSummary { tracks: &tracks, ..run(&map) }).unwrap();
        assert_eq!(found.mapping, 0.0, "{found:?}");
        assert_eq!((found.coverage, found.f1_30, found.f1_15), (1.0, 1.0, 1.0));
        assert_eq!(found.ghosting, 0.0);
        assert!(found.wall_distance < 0.05, "{}", found.wall_distance);
    }
}

#[test]
fn the_empty_map_has_nothing() {
    let truth = truth(&flat());
    let found = scores(&truth, &OccupancyMap::new());
    assert_eq!(
        (found.coverage, found.f1_30, found.recall_30, found.navigability),
        (0.0, 0.0, 0.0, 0.0)
    );
    assert_eq!((found.wall_distance, found.ghosting), (1.0, 0.0));
    assert!((found.score_1.mapping - 7.5).abs() < 1e-12, "{}", found.score_1.mapping);
}

#[test]
fn a_shift_counts_by_its_length() {
    let truth = truth(&flat());
    let map = truth.perfect_map();
    let shifted = scores(&truth, &moved(&map, (4, 0), false));
    assert_eq!(shifted.f1_30, 1.0);
    assert!(shifted.f1_15 < 0.9 && shifted.ghosting == 0.0, "{shifted:?}");
    assert!(shifted.wall_distance > 0.05 && shifted.wall_distance < 0.2);
    let far = scores(&truth, &moved(&map, (10, 10), false));
    assert!(far.f1_30 < 0.5 && far.mapping > shifted.mapping, "{far:?}");
    // Entirely out of the world.
    let lost = scores(&truth, &moved(&map, (4000, -9000), false));
    assert_eq!((lost.f1_30, lost.coverage, lost.wall_distance), (0.0, 0.0, 1.0));
}

#[test]
fn a_doubled_corridor_lowers_precision_not_recall() {
    let truth = truth(&flat());
    let map = truth.perfect_map();
    let doubled = scores(&truth, &moved(&map, (0, 10), true));
    assert_eq!(doubled.recall_30, 1.0);
    assert!(doubled.precision_30 < 0.8, "{}", doubled.precision_30);
    assert!(doubled.ghosting > 0.4, "{}", doubled.ghosting);
}

#[test]
fn a_smeared_map_covers_no_more() {
    let truth = truth(&flat());
    let mut map = truth.perfect_map();
    let before = scores(&truth, &map);
    for col in -100..400 {
        for row in -100..300 {
            let index = CellIndex { col, row };
            if map.cell(index) == Cell::Unknown {
                map.add(index, -CLAMP);
            }
        }
    }
    assert_eq!(scores(&truth, &map).coverage, before.coverage);
}

#[test]
fn a_map_that_closes_a_door_or_hides_a_wall_is_not_navigable() {
    let truth = truth(&flat());
    let perfect = truth.perfect_map();
    let mut closed = perfect.clone();
    for row in 55..95 {
        let cell = CellIndex { col: 160, row };
        closed.add(cell, CLAMP);
        closed.add(cell, CLAMP);
    }
    let found = scores(&truth, &announced(closed));
    assert!(found.navigability < 0.9 && found.navigability > 0.1, "{}", found.navigability);
    let mut open = perfect.clone();
    for (cell, odds) in known(&perfect) {
        let middle = cell.centre();
        if odds > 0 && (4.0..12.0).contains(&middle.x) && (1.0..7.0).contains(&middle.y) {
            open.add(cell, -CLAMP);
            open.add(cell, -CLAMP);
        }
    }
    for col in 100..222 {
        for row in 58..92 {
            open.add(CellIndex { col, row }, -CLAMP);
        }
    }
    let found = scores(&truth, &announced(open));
    assert!(found.navigability < 1.0, "{}", found.navigability);
}

#[test]
fn an_empty_room_driven_through_is_easy() {
    let truth = truth(&room(20.0, 20.0));
    let map = truth.perfect_map();
    // As the policies drive: a round of 60 m, with some turning.
    let run = RunSummary { time: 150.0, distance: 60.0, turning: 15.0, ..run(&map) };
    let found = Scores::of(&truth, &run).unwrap();
    assert!(found.difficulty < 1.0, "{}", found.difficulty);
    let one = found.score_1;
    assert!(one.difficulty < 1.0, "{}", one.difficulty);
    assert!((one.e_time - 150.0 / (150.0 + 1.5 * found.free_area)).abs() < 1e-12);
    assert!((one.e_turn - 0.2).abs() < 1e-12);
    assert!((one.difficulty - 0.4 * one.navigation).abs() < 1e-12);
}

#[test]
fn trouble_makes_getting_around_difficult() {
    let truth = truth(&room(6.0, 4.0));
    let map = truth.perfect_map();
    let found = Scores::of(&truth, &RunSummary { collisions: 2, stuck: 1, ..run(&map) }).unwrap();
    let one = found.score_1;
    assert!((one.e_hit - (1.0 - libm::exp(-1.0))).abs() < 1e-12);
    assert!((one.navigation - 2.0 * one.e_hit).abs() < 1e-12);
    let poses = [Pose::new(1.0, 1.0, 0.0), Pose::new(2.0, 1.0, 0.0)];
    let off = poses.map(|pose| Pose { position: pose.position + DVec2::new(0.3, 0.4), ..pose });
    let tracks = [TrajectoryPair { truth: &poses, estimated: &off }];
    let found = Scores::of(&truth, &RunSummary { tracks: &tracks, ..run(&map) }).unwrap();
    assert!(
        (found.trajectory_error - 0.5).abs() < 1e-12 && (found.score_1.e_pose - 0.5).abs() < 1e-12
    );
    assert!(found.relative_error_near.is_some_and(|error| error < 1e-12));
    assert_eq!(found.relative_error_far, None);
}

#[test]
fn unsound_runs_have_no_scores() {
    let truth = truth(&room(6.0, 4.0));
    let map = OccupancyMap::new();
    let poses = [Pose::default(), Pose::new(f64::NAN, 0.0, 0.0)];
    let tracks = [TrajectoryPair { truth: &poses, estimated: &poses[..1] }];
    let error = Scores::of(&truth, &RunSummary { tracks: &tracks, ..run(&map) }).unwrap_err();
    assert_eq!(error, ScoreError::Lengths { robot: 0, truth: 2, estimated: 1 });
    let tracks = [TrajectoryPair { truth: &poses, estimated: &poses }];
    let error = Scores::of(&truth, &RunSummary { tracks: &tracks, ..run(&map) }).unwrap_err();
    assert_eq!(error, ScoreError::Pose { robot: 0, tick: 1 });
    for value in [-1.0, f64::NAN, f64::INFINITY] {
        let error = Scores::of(&truth, &RunSummary { turning: value, ..run(&map) }).unwrap_err();
        assert!(error.to_string().contains("`turning`"), "{error}");
    }
}

#[test]
fn scores_come_back_and_are_flat_but_for_score_1() {
    let truth = truth(&room(6.0, 4.0));
    let found = scores(&truth, &truth.perfect_map());
    let json = serde_json::to_value(found).unwrap();
    let objects = json.as_object().unwrap().iter().filter(|(_, value)| value.is_object());
    assert_eq!(objects.map(|(name, _)| name.as_str()).collect::<Vec<_>>(), ["score_1"]);
    assert_eq!(serde_json::from_value::<Scores>(json).unwrap(), found);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(32))]

    #[test]
    fn shares_are_shares_whatever_the_map(
        cells in prop::collection::vec((-60..400_i32, -60..300_i32, -400..400_i16), 0..400),
        (time, turning) in (0.0..1e300_f64, 0.0..1e300_f64),
        collisions in 0..u32::MAX,
    ) {
        let truth = truth(&room(3.0, 2.0));
        let mut map = OccupancyMap::new();
        for (col, row, odds) in cells {
            map.add(CellIndex { col, row }, odds);
        }
        let run = RunSummary { time, turning, collisions, stuck: collisions, ..run(&map) };
        let s = Scores::of(&truth, &run).unwrap();
        for share in [
            s.e_wall, s.e_use, s.e_pose, s.e_cov, s.e_time, s.e_hit, s.e_turn, s.coverage,
            s.precision_30, s.recall_30, s.f1_30, s.precision_15, s.recall_15, s.f1_15,
            s.ghosting, s.navigability, s.wall_distance,
        ] {
            prop_assert!((0.0..=1.0).contains(&share), "{s:?}");
        }
        prop_assert!(s.precision_15 <= s.precision_30 && s.recall_15 <= s.recall_30);
        let one = s.score_1;
        for share in [one.e_use, one.e_pose, one.e_time, one.e_hit, one.e_turn] {
            prop_assert!((0.0..=1.0).contains(&share), "{s:?}");
        }
        for difficulty in
            [s.difficulty, s.mapping, s.navigation, one.difficulty, one.mapping, one.navigation]
        {
            prop_assert!((0.0..=10.0).contains(&difficulty), "{s:?}");
        }
    }

    #[test]
    fn one_wall_more_than_there_is_never_helps(col in 4..110_i32, row in 4..70_i32) {
        let truth = truth(&room(6.0, 4.0));
        let mut map = truth.perfect_map();
        let before = scores(&truth, &map);
        map.add(CellIndex { col, row }, 2 * CLAMP);
        let after = scores(&truth, &map);
        prop_assert!(after.mapping >= before.mapping);
        let p = CellIndex { col, row }.centre();
        let walls = p.min(DVec2::new(6.0, 4.0) - p).min_element();
        // Half a score cell to either side, at most.
        prop_assert!(after.precision_30 < 1.0 || walls < 0.4);
        prop_assert!(after.precision_30 == 1.0 || walls > 0.2);
    }
}

#[test]
fn an_empty_room_has_all_its_trips() {
    assert_eq!(truth(&room(20.0, 20.0)).trips().len(), 8);
}

/// A map without what it shows in a rectangle of its cells.
fn without(map: &OccupancyMap, (low, high): (CellIndex, CellIndex)) -> OccupancyMap {
    let mut result = OccupancyMap::new();
    for (cell, odds) in known(map) {
        if !((low.col..high.col).contains(&cell.col) && (low.row..high.row).contains(&cell.row)) {
            result.add(cell, odds);
        }
    }
    announced(result)
}

/// Cells of a rectangle of the world of `flat`, 16 x 8 m: whole cells of the score, which are free only if
/// nothing in them is occupied.
fn region() -> impl Strategy<Value = (CellIndex, CellIndex)> {
    (0..160, 0..80, 5..100, 5..60).prop_map(|(col, row, cols, rows)| {
        let cell = |col, row| CellIndex { col: 2 * col, row: 2 * row };
        (cell(col, row), cell(col + cols, row + rows))
    })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    /// What was not reached never helps: a map that lacks a region has no smaller part than the
    /// whole one. Where the whole one is wrong this holds for `e_cov` and `e_time` alone: its wrong
    /// walls count until they are taken out.
    #[test]
    fn what_was_not_reached_never_helps(
        first in region(), second in region(), shift in 0..8_i32, time in 0.0..1200.0_f64,
        (distance, turning, collisions) in (0.0..600.0_f64, 0.0..400.0_f64, 0..30_u32),
    ) {
        let truth = truth(&flat());
        let perfect = truth.perfect_map();
        let of = |map: &OccupancyMap| {
            let run = RunSummary { time, distance, turning, collisions, ..run(map) };
            Scores::of(&truth, &run).expect("a sound run")
        };
        let part = without(&perfect, first);
        let (whole, less, least) = (of(&perfect), of(&part), of(&without(&part, second)));
        for (more, less) in [(&whole, &less), (&less, &least)] {
            let [before, after] = [more, less].map(Scores::parts);
            prop_assert!(after.e_wall >= before.e_wall, "{before:?} {after:?}");
            prop_assert!(after.e_cov >= before.e_cov && after.e_time >= before.e_time);
            let unchanged = |parts: Parts| [parts.e_pose, parts.e_hit, parts.e_turn];
            prop_assert_eq!(unchanged(before), unchanged(after));
            prop_assert!(less.navigation >= more.navigation);
        }
        for less in [&less, &least] {
            // Paths avoid what is not known: with more of it missing, one may miss a wall that is
            // not on the map either.
            prop_assert!(less.e_use >= whole.e_use);
            prop_assert!(less.mapping >= whole.mapping && less.difficulty >= whole.difficulty);
        }
        let wrong = moved(&perfect, (shift, 0), false);
        let (whole, less) = (of(&wrong), of(&without(&wrong, first)));
        prop_assert!(less.e_cov >= whole.e_cov && less.e_time >= whole.e_time);
        prop_assert!(less.navigation >= whole.navigation);
    }
}
