//! Mazes in rooms: every place inside can be reached, by passages of a given width.
//!
//! A room is divided into squares, which are connected by a random spanning tree (Kruskal, 1956). A share of the
//! dead ends is then opened ("braided"), and walls in front of doorways are removed.

use glam::DVec2;

use super::catalogue::SharedRoom;
use super::catalogue::design::{MAX_ROOM_PARTS, RoomDesign};
use super::grid::Opening;
use super::interior::doorway_zone;
use super::materials::shuffled;
use super::placed_room::PlacedRoom;
use super::room_placement::DESIGN_UNIT;
use super::spec::IndoorSpec;
use crate::geometry::{Rect, Shape};
use crate::seed::Seed;
use crate::union_find::UnionFind;
use crate::world::{Contents, Wall, WallKind};

/// Replaces the contents of a share of the rooms, by area, with mazes; does nothing if the spec has no mazes.
///
/// Rooms have their own random order and are taken from its start, so that a larger share adds mazes to those of a
/// smaller share. Rooms that are too small for two passages keep their contents.
pub(super) fn place(spec: &IndoorSpec, seed: Seed, openings: &[Opening], rooms: &mut [PlacedRoom]) {
    if spec.mazes == 0.0 {
        return;
    }
    let fits = |room: &PlacedRoom| Lattice::new(spec, &room.room).is_some();
    let able: Vec<usize> = (0..rooms.len()).filter(|&i| fits(&rooms[i])).collect();
    let cells = |room: &PlacedRoom| f64::from(room.room.width * room.room.height);
    let all: f64 = able.iter().map(|&i| cells(&rooms[i])).sum();
    let mut wanted = spec.mazes * all;
    for which in shuffled(able.len(), seed, "indoor/mazes") {
        let i = able[which];
        let own = cells(&rooms[i]);
        if wanted < 0.5 * own {
            break;
        }
        wanted -= own;
        let Some(lattice) = Lattice::new(spec, &rooms[i].room) else { continue };
        let walls = lattice.walls(spec.maze_braid, seed, i as u64);
        let zones = zones(spec, openings, &rooms[i]);
        let mut design = rooms[i].room.emptied();
        let scale = DESIGN_UNIT / spec.cell_size;
        design.walls = lattice.boxes(walls, spec.wall_thickness, &zones, scale);
        // Nobody lies in a wall.
        let need = scale * spec.robot_radius;
        let is_free = |at: DVec2| design.walls.iter().all(|wall| wall.shape.distance(at) >= need);
        let victims = design.victims.iter().copied().filter(|victim| is_free(victim.position));
        design.victims = victims.collect();
        if let Ok(room) = SharedRoom::new(design) {
            rooms[i] = PlacedRoom { room, contents: Contents::Maze, ..rooms[i].clone() };
        }
    }
}

/// Returns the zones behind the doorways of a room that must remain clear, in metres, in the frame of the unturned
/// room.
fn zones(spec: &IndoorSpec, openings: &[Opening], room: &PlacedRoom) -> Vec<Rect> {
    let size = DVec2::new(f64::from(room.room.width), f64::from(room.room.height));
    openings
        .iter()
        .filter_map(|opening| {
            let (side, at) = room.side_of(opening.gate)?;
            let length = |side| 2 * room.room.side_length(side);
            let (side, at) = side.before_turn(at, room.quarters, length);
            Some(doorway_zone(spec.dimensions(), size * spec.cell_size, side, at))
        })
        .collect()
}

/// The squares of a maze.
struct Lattice {
    columns: usize,
    rows: usize,
    /// Size of a square in metres.
    pitch: DVec2,
}

/// A wall between two squares: above the first square, or to its right.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
struct Edge {
    squares: [usize; 2],
}

impl Lattice {
    /// Divides a room into as many squares as passages of the wanted width fit into it; `None` if there are not two
    /// in each direction, or too many for a room.
    fn new(spec: &IndoorSpec, room: &RoomDesign) -> Option<Self> {
        let count = |cells: u32| {
            let length = f64::from(cells) * spec.cell_size;
            // What fits to a nanometre fits.
            let pitch = spec.maze_passage + spec.wall_thickness - 1e-9;
            (length / pitch) as usize
        };
        let (columns, rows) = (count(room.width), count(room.height));
        let is_possible = columns >= 2 && rows >= 2 && columns * rows <= MAX_ROOM_PARTS / 2;
        is_possible.then(|| {
            let size = DVec2::new(f64::from(room.width), f64::from(room.height)) * spec.cell_size;
            Lattice { columns, rows, pitch: size / DVec2::new(columns as f64, rows as f64) }
        })
    }

    fn edges(&self) -> Vec<Edge> {
        let mut edges = Vec::new();
        for square in 0..self.columns * self.rows {
            if (square + 1) % self.columns != 0 {
                edges.push(Edge { squares: [square, square + 1] });
            }
            if square + self.columns < self.columns * self.rows {
                edges.push(Edge { squares: [square, square + self.columns] });
            }
        }
        edges
    }

    /// Returns the walls that remain.
    fn walls(&self, braid: f64, seed: Seed, room: u64) -> Vec<Edge> {
        let own = Seed(seed.attempt("indoor/maze", room, 0).bits());
        let edges = self.edges();
        let mut sets = UnionFind::new(self.columns * self.rows);
        let mut walls = Vec::new();
        for i in shuffled(edges.len(), own, "indoor/maze/tree") {
            let [a, b] = edges[i].squares;
            if sets.find(a) == sets.find(b) {
                walls.push(edges[i]);
            } else {
                sets.join(a, b);
            }
        }
        self.braid(braid, own, &mut walls);
        walls
    }

    /// Opens a share of the dead ends. An opening may end two of them.
    fn braid(&self, share: f64, seed: Seed, walls: &mut Vec<Edge>) {
        let mut exits = vec![0_u32; self.columns * self.rows];
        for edge in self.edges() {
            edge.squares.into_iter().for_each(|square| exits[square] += 1);
        }
        for edge in &*walls {
            edge.squares.into_iter().for_each(|square| exits[square] -= 1);
        }
        let dead_ends: Vec<usize> = (0..exits.len()).filter(|&i| exits[i] == 1).collect();
        let count = (share * dead_ends.len() as f64).round() as usize;
        for which in shuffled(dead_ends.len(), seed, "indoor/maze/braid").into_iter().take(count) {
            let square = dead_ends[which];
            if exits[square] > 1 {
                continue;
            }
            // A wall to another dead end first.
            let around =
                walls.iter().enumerate().filter(|(_, edge)| edge.squares.contains(&square));
            let fewest = around
                .min_by_key(|(_, edge)| edge.squares.map(|i| exits[i]).into_iter().sum::<u32>());
            let Some((place, _)) = fewest else { continue };
            let opened = walls.remove(place);
            opened.squares.into_iter().for_each(|i| exits[i] += 1);
        }
    }

    /// Returns the walls as boxes in the frame of the design, with collinear pieces joined. Walls in a zone are
    /// left out.
    fn boxes(&self, walls: Vec<Edge>, thickness: f64, zones: &[Rect], scale: f64) -> Vec<Wall> {
        let half = 0.5 * thickness;
        // Line, from, to: in squares, for walls across and along.
        let mut runs: [Vec<(usize, usize, usize)>; 2] = Default::default();
        for edge in walls {
            let [first, second] = edge.squares;
            let (column, row) = (first % self.columns, first / self.columns);
            let (axis, line, at) =
                if second == first + 1 { (0, column + 1, row) } else { (1, row + 1, column) };
            let rect = self.rect(axis, (line, at, at + 1), half);
            let is_blocked = zones
                .iter()
                .any(|zone| rect.min.cmplt(zone.max).all() && zone.min.cmplt(rect.max).all());
            if !is_blocked {
                runs[axis].push((line, at, at + 1));
            }
        }
        let mut boxes = Vec::new();
        for (axis, mut pieces) in runs.into_iter().enumerate() {
            pieces.sort_unstable();
            let mut lines: Vec<(usize, usize, usize)> = Vec::new();
            for piece in pieces {
                match lines.last_mut() {
                    Some(last) if last.0 == piece.0 && last.2 == piece.1 => last.2 = piece.2,
                    _ => lines.push(piece),
                }
            }
            boxes.extend(lines.into_iter().map(|line| {
                let Rect { min, max } = self.rect(axis, line, half);
                let shape = Shape::from_rect(Rect::new(min * scale, max * scale));
                Wall::new(WallKind::Wall, shape)
            }));
        }
        boxes
    }

    /// Returns the rectangle of a wall in metres. It fills the corners at its ends, within the room.
    fn rect(&self, axis: usize, (line, from, to): (usize, usize, usize), half: f64) -> Rect {
        let end = self.pitch * DVec2::new(self.columns as f64, self.rows as f64);
        let across = line as f64 * self.pitch[axis];
        let along = |at: usize| at as f64 * self.pitch[1 - axis];
        let mut min = DVec2::ZERO;
        let mut max = DVec2::ZERO;
        (min[axis], max[axis]) = (across - half, across + half);
        (min[1 - axis], max[1 - axis]) = (along(from) - half, along(to) + half);
        Rect::new(min.max(DVec2::ZERO), max.min(end))
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::Spec;
    use crate::certificate::{Verdict, verify};
    use crate::indoor::interior::Interior;
    use crate::indoor::tests::small_world as world;

    fn lattice(columns: usize, rows: usize) -> Lattice {
        Lattice { columns, rows, pitch: DVec2::ONE }
    }

    /// The number of exits of each square, and the number of pieces.
    fn exits(lattice: &Lattice, walls: &[Edge]) -> (Vec<u32>, usize) {
        let squares = lattice.columns * lattice.rows;
        let mut sets = UnionFind::new(squares);
        let mut exits = vec![0; squares];
        for edge in lattice.edges().into_iter().filter(|edge| !walls.contains(edge)) {
            edge.squares.into_iter().for_each(|i| exits[i] += 1);
            sets.join(edge.squares[0], edge.squares[1]);
        }
        let pieces: std::collections::BTreeSet<_> = (0..squares).map(|i| sets.find(i)).collect();
        (exits, pieces.len())
    }

    #[test]
    fn a_tree_has_dead_ends_and_a_braid_has_none() {
        let lattice = lattice(12, 9);
        for seed in 0..20 {
            let walls = |braid| lattice.walls(braid, Seed(seed), 0);
            let (tree, pieces) = exits(&lattice, &walls(0.0));
            assert_eq!((tree.iter().sum::<u32>(), pieces), (2 * (12 * 9 - 1), 1), "a tree");
            let dead = |exits: &[u32]| exits.iter().filter(|exits| **exits == 1).count();
            let all = dead(&tree);
            assert!(all > 15, "{all}");
            let (half, pieces) = exits(&lattice, &walls(0.5));
            assert!(pieces == 1 && dead(&half) <= all.div_ceil(2) && dead(&half) > 0);
            assert_eq!(dead(&exits(&lattice, &walls(1.0)).0), 0);
        }
    }

    #[test]
    fn mazes_add_up_and_certificates_hold() {
        let plain = world(&IndoorSpec::default(), 4);
        let mut taken = 0;
        for seed in 0..12 {
            let at = |mazes: f64| {
                world(&IndoorSpec { mazes, maze_passage: 1.2, ..Default::default() }, seed)
            };
            let count = |world: &crate::World| {
                world.rooms.iter().filter(|room| room.contents == Contents::Maze).count()
            };
            let (half, whole) = (at(0.5), at(1.0));
            let is_maze =
                |i: usize, world: &crate::World| world.rooms[i].contents == Contents::Maze;
            assert!((0..half.rooms.len()).all(|i| !is_maze(i, &half) || is_maze(i, &whole)));
            assert!(count(&half) < count(&whole));
            taken += count(&whole);
            whole.check().expect("a sound world");
            for (claim, verdict) in verify(&whole) {
                assert_eq!(verdict, Verdict::Holds, "seed {seed}: {claim}");
            }
        }
        assert!(taken > 60, "{taken}");
        assert_eq!(
            world(&IndoorSpec { maze_passage: 2.0, ..Default::default() }, 4).walls,
            plain.walls
        );
    }

    #[test]
    fn a_passage_is_wide_enough_for_the_robot() {
        let spec = IndoorSpec { mazes: 0.5, maze_passage: 0.8, ..Default::default() };
        let error = spec.generate(Seed(0)).unwrap_err().to_string();
        assert_eq!(
            error,
            "`maze_passage` must be at least 0.82 m, which the robot passes, got 0.8"
        );
    }

    proptest! {
        #[test]
        fn every_room_is_one_piece(
            seed in any::<u64>(),
            maze_passage in 0.82..4.0_f64,
            maze_braid in 0.0..=1.0_f64,
            wall_thickness in 0.02..0.3_f64,
            cell_size in 1.6..6.0_f64,
        ) {
            let spec = IndoorSpec {
                width: 7, height: 6, mazes: 1.0,
                maze_passage, maze_braid, wall_thickness, cell_size, ..Default::default()
            };
            prop_assume!(spec.validate().is_ok());
            let plan = spec.generate(Seed(seed)).expect("a plan");
            for room in plan.rooms().iter().filter(|room| room.contents == Contents::Maze) {
                let interior = Interior::new(&room.room, spec.dimensions());
                prop_assert_eq!(interior.parts().len(), 1);
                for opening in plan.openings() {
                    if room.side_of(opening.gate).is_some() {
                        prop_assert!(room.port(opening.gate, spec.dimensions()).usable());
                    }
                }
            }
        }
    }
}
