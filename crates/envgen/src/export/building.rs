//! A world as `building.yaml`, the file in which the traffic editor of Open-RMF stores a building.
//!
//! Coordinates are `cartesian_meters`, and equal those of the world. The only level has walls, doors, a floor, and
//! the lanes of navigation graph 0. RMF's walls are lines, which its tools make 0.1 m thick: thin walls become
//! their centre line, every other solid its outline. Each doorway is a hinged door that turns by 90 degrees about
//! its first end. Lanes lead from the start to the goal and into every room, as near to the room's middle as a
//! robot with a radius of 0.3 m can go. Values have a type: 1 text, 2 whole number, 3 number, 4 truth value. Walls
//! and doors state their `bottom` and `top` in metres, which RMF's tools ignore: their walls are 2.5 m high.

use std::collections::BTreeMap;
use std::io::{self, BufWriter, Write};

use glam::DVec2;

use super::error::ExportError;
use super::lanes::Lanes;
use super::yaml::quoted;
use crate::doorways::{jambs_of_narrow, near_middles};
use crate::geometry::{Shape, edges, regular_polygon};
use crate::world::{PartId, PartKind, World};

/// Walls of up to this thickness in metres become their centre line.
const THIN: f64 = 0.5;

/// The greatest relative difference between the area of a polygon that counts as a rectangle and that of a rectangle.
const RECTANGULAR: f64 = 1e-6;

/// Number of corners of the outline of a disc.
const CORNERS: usize = 16;

/// Writes the building of a world.
pub(super) fn write(world: &World, out: &mut dyn Write) -> Result<(), ExportError> {
    let mut out = BufWriter::new(out);
    let mut plan = Plan::default();
    plan.add_places(world);
    plan.add_walls(world);
    plan.add_doors(world);
    let floor = plan.ring(&Shape::from_rect(world.bounds).corners());
    let name = quoted(&world.provenance.name());
    let provenance = serde_json::to_string(&world.provenance).map_err(io::Error::from)?;
    writeln!(out, "coordinate_system: cartesian_meters\ncrowd_sim: {{}}\ngraphs: {{}}")?;
    writeln!(out, "levels:\n  L1:")?;
    list(&mut out, "doors", &plan.doors)?;
    writeln!(out, "    elevation: 0\n    fiducials: []")?;
    let floor = format!(
        "{{parameters: {{texture_name: [1, blue_linoleum], texture_rotation: [3, 0], texture_scale: \
         [3, 1]}}, vertices: {floor:?}}}"
    );
    list(&mut out, "floors", &[floor])?;
    list(&mut out, "lanes", &plan.lanes)?;
    writeln!(out, "    layers: {{}}\n    measurements: []\n    models: []")?;
    list(&mut out, "vertices", &plan.vertices)?;
    list(&mut out, "walls", &plan.walls)?;
    writeln!(out, "lifts: {{}}\nmap_version: 2\nname: {name}")?;
    writeln!(out, "parameters:\n  provenance: [1, {}]", quoted(&provenance))?;
    Ok(out.flush()?)
}

fn list(out: &mut dyn Write, name: &str, items: &[String]) -> io::Result<()> {
    if items.is_empty() {
        return writeln!(out, "    {name}: []");
    }
    writeln!(out, "    {name}:")?;
    items.iter().try_for_each(|item| writeln!(out, "      - {item}"))
}

/// The lists of a level, with one text per entry.
#[derive(Default)]
struct Plan {
    vertices: Vec<String>,
    walls: Vec<String>,
    doors: Vec<String>,
    lanes: Vec<String>,
    /// Indices of vertices by the bits of their coordinates.
    known: BTreeMap<[u64; 2], usize>,
}

impl Plan {
    /// Returns the number of the vertex at a point, which is added if necessary.
    fn vertex(&mut self, at: DVec2) -> usize {
        let key = (at + DVec2::ZERO).to_array().map(f64::to_bits);
        if let Some(&known) = self.known.get(&key) {
            return known;
        }
        self.known.insert(key, self.vertices.len());
        self.named(at, "", "")
    }

    /// Adds a separate vertex with a name.
    fn named(&mut self, at: DVec2, name: &str, parameters: &str) -> usize {
        let entry = format!("[{}, {}, 0, {}, {{{parameters}}}]", at.x, at.y, quoted(name));
        self.vertices.push(entry);
        self.vertices.len() - 1
    }

    fn ring(&mut self, corners: &[DVec2]) -> Vec<usize> {
        corners.iter().map(|&corner| self.vertex(corner)).collect()
    }

    fn wall(&mut self, a: DVec2, b: DVec2, height: &str) {
        let (from, to) = (self.vertex(a), self.vertex(b));
        if from != to {
            self.walls.push(format!(
                "[{from}, {to}, {{alpha: [3, 1], {height}, texture_name: [1, default]}}]"
            ));
        }
    }

    fn add_walls(&mut self, world: &World) {
        let thin = world.walls.len();
        // Closed doors are doors.
        let solids = world.solids().filter(|solid| solid.id.kind != PartKind::Doorway);
        for (i, solid) in solids.enumerate() {
            let height = height(world, solid.id);
            match centre_line(&solid.shape) {
                Some((a, b, thickness)) if i < thin && thickness <= THIN => {
                    self.wall(a, b, &height)
                }
                _ => {
                    let corners = match &*solid.shape {
                        Shape::Disc { center, radius } => regular_polygon(*radius, CORNERS)
                            .into_iter()
                            .map(|corner| *center + corner)
                            .collect(),
                        shape => shape.corners(),
                    };
                    edges(&corners).for_each(|(a, b)| self.wall(a, b, &height));
                }
            }
        }
    }

    fn add_doors(&mut self, world: &World) {
        let walls = world.solids().filter(|solid| solid.id.kind != PartKind::Doorway);
        let walls: Vec<Shape> = walls.map(|solid| solid.shape.into_owned()).collect();
        let diagonals = world.doorways.iter().map(|doorway| doorway.shape.bounds().size().length());
        let reach = diagonals.fold(0.0, f64::max);
        let near = near_middles(world.doorways.iter(), walls.iter().map(Shape::bounds), reach);
        for (i, doorway) in world.doorways.iter().enumerate() {
            let beside = near.at(doorway.shape.bounds().center()).iter();
            let narrow = jambs_of_narrow(doorway, beside.map(|&wall| &walls[wall as usize]));
            let [a, b] = narrow.unwrap_or_else(|| {
                let (a, b, _) = doorway.shape.long_axis();
                [a, b]
            });
            let (from, to) = (self.vertex(a), self.vertex(b));
            let height = height(world, PartId { kind: PartKind::Doorway, index: i as u32 });
            self.doors.push(format!(
                "[{from}, {to}, {{{height}, motion_axis: [1, start], motion_degrees: [3, 90], motion_direction: \
                 [2, 1], name: [1, doorway_{i}], plugin: [1, normal], right_left_ratio: [3, 1], type: \
                 [1, hinged]}}]"
            ));
        }
    }

    /// Adds the start, the goal, the middles of rooms, and the lanes between them.
    fn add_places(&mut self, world: &World) {
        let spot = "is_parking_spot: [4, true]";
        let start = world.start.map(|start| self.named(start.position, "start", spot));
        let goal = world.goal.map(|goal| (goal.position, self.named(goal.position, "goal", "")));
        let lanes_from = world.start.and_then(|start| Lanes::from(world, start.position));
        let rooms = world.rooms.iter().enumerate();
        let rooms = rooms.map(|(i, room)| {
            let middle = room.shape.bounds().center();
            let nearest =
                lanes_from.as_ref().and_then(|lanes| lanes.nearest_in(&room.shape, middle));
            let at = nearest.unwrap_or(middle);
            (at, self.named(at, &format!("{} {i}", room.name), ""))
        });
        let targets: Vec<_> = goal.into_iter().chain(rooms).collect();
        let (Some(from), Some(lanes_from)) = (start, lanes_from) else { return };
        let mut lanes = BTreeMap::new();
        for (at, vertex) in targets {
            let Some(turns) = lanes_from.turns(at) else { continue };
            let mut before = from;
            for point in turns {
                let next = self.vertex(point);
                lanes.entry([before.min(next), before.max(next)]).or_insert([before, next]);
                before = next;
            }
            lanes.entry([before.min(vertex), before.max(vertex)]).or_insert([before, vertex]);
        }
        self.lanes = lanes
            .values()
            .filter(|[from, to]| from != to)
            .map(|[from, to]| {
                format!(
                    "[{from}, {to}, {{bidirectional: [4, true], graph_idx: [2, 0], orientation: \
                     [1, \"\"], speed_limit: [3, 0]}}]"
                )
            })
            .collect();
    }
}

/// Returns the line along the middle of a shape's longer side, and its thickness; `None` for a shape that is not a
/// rectangle.
fn centre_line(shape: &Shape) -> Option<(DVec2, DVec2, f64)> {
    let axis = shape.long_axis();
    let is_rectangle = match shape {
        Shape::Segment { .. } | Shape::Box { .. } => true,
        Shape::Disc { .. } => false,
        Shape::Polygon { vertices } => {
            let area = axis.0.distance(axis.1) * axis.2;
            vertices.len() == 4 && (shape.area() - area).abs() <= RECTANGULAR * area
        }
    };
    is_rectangle.then_some(axis)
}

/// Returns the bottom and top of a part as text.
fn height(world: &World, part: PartId) -> String {
    let (bottom, top) = world.extent(part).map_or((0.0, 0.0), |it| (it.bottom(), it.top()));
    format!("bottom: [3, {bottom}], top: [3, {top}]")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::generate::{Blueprint, Spec};
    use crate::indoor::IndoorSpec;
    use crate::seed::Seed;

    #[test]
    fn doors_close_doorways_that_are_narrower_than_their_wall() {
        for doorway in [0.3, 0.5, 1.0] {
            let robot_radius = 0.1;
            let (cell_size, wall_thickness) = (2.3, 0.5);
            let spec = IndoorSpec {
                width: 10,
                height: 10,
                cell_size,
                wall_thickness,
                doorway,
                robot_radius,
                ..Default::default()
            };
            let world = spec.generate(Seed(3)).expect("a map").to_world();
            let mut plan = Plan::default();
            plan.add_doors(&world);
            assert!(plan.doors.len() > 10 && plan.doors.len() == world.doorways.len());
            let numbers = |text: &str| -> Vec<f64> {
                let parts = text.trim_start_matches('[').split(", ");
                parts.take(2).map(|part| part.parse().expect("a number")).collect()
            };
            let vertices = plan.vertices.iter().map(|vertex| numbers(vertex));
            let vertices: Vec<DVec2> = vertices.map(|at| DVec2::new(at[0], at[1])).collect();
            for door in &plan.doors {
                let [from, to] = [0, 1].map(|i| vertices[numbers(door)[i] as usize]);
                assert!((from.distance(to) - doorway).abs() < 1e-9, "{doorway}: {from} to {to}");
                let is_wall = |p| world.walls.iter().any(|wall| wall.shape.distance(p) < 1e-6);
                assert!(is_wall(from) && is_wall(to), "{doorway}: {from} to {to}");
            }
        }
    }
}
