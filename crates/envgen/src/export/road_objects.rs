//! The solid parts of a world with roads, as objects of ASAM OpenDRIVE: walls (including kerbs), lintels, closed
//! doors, trees and obstacles, each with its bottom and top.
//!
//! An object belongs to the road whose reference line is nearest to its middle. The heading of its local axes is
//! that of this line. Their origin lies on the normal of the line or, if the middle is beyond an end of the line or
//! outside a kink, on the line.

use glam::DVec2;

use super::error::ExportError;
use super::xml::{Attribute, Xml, number};
use crate::curve::{Path, PathIndex};
use crate::geometry::{Pose, Shape, unit_vector, wrap_angle};
use crate::outline::outline;
use crate::pieces::{Form, Piece, pieces};
use crate::world::{Extent, PartKind, World};

/// The greatest distance, in metres, of a point that counts as on the normal of the reference line.
const BESIDE: f64 = 1e-9;

/// The distance from a kink, in metres, at which the heading is read, because there are two headings at the kink.
const OFF_KINKS: f64 = 1e-6;

/// The least turn of a kink within twice that distance, in radians. Curves turn by less.
const KINK: f64 = 1e-3;

/// The solid pieces of a world, by road.
pub(super) struct RoadObjects<'a>(Vec<Vec<Object<'a>>>);

/// A solid piece, and the position of its local axes.
struct Object<'a> {
    piece: Piece<'a>,
    /// Distance along the road in metres.
    s: f64,
    /// The pose of the reference line there.
    line: Pose,
}

impl<'a> RoadObjects<'a> {
    /// Assigns the solid pieces of a world to its roads, which have these reference lines.
    pub(super) fn of(world: &'a World, paths: &[Path<'_>]) -> Self {
        let indices: Vec<PathIndex> = paths.iter().map(PathIndex::new).collect();
        let mut roads: Vec<Vec<Object<'a>>> = paths.iter().map(|_| Vec::new()).collect();
        for piece in pieces(world).into_iter().filter(|piece| piece.is_solid) {
            let Form::Prism { shape, .. } = &piece.form else { continue };
            let middle = shape.bounds().center();
            let nearest = indices
                .iter()
                .enumerate()
                .filter_map(|(road, index)| Some((road, index.locate(middle)?)))
                .min_by(|a, b| a.1.offset.abs().total_cmp(&b.1.offset.abs()));
            if let Some((road, located)) = nearest {
                let (s, line) = off_kinks(&paths[road], located.s);
                roads[road].push(Object { piece, s, line });
            }
        }
        RoadObjects(roads)
    }

    /// Writes the objects of a road.
    pub(super) fn write(&self, xml: &mut Xml<'_>, road: usize) -> Result<(), ExportError> {
        if self.0[road].is_empty() {
            return Ok(());
        }
        xml.nest("objects", &[], |xml| {
            self.0[road].iter().try_for_each(|object| write_object(xml, object))
        })
    }
}

/// Returns the position at a distance along a path, or one beside it if the path has a kink there.
fn off_kinks(path: &Path<'_>, s: f64) -> (f64, Pose) {
    let end = path.length();
    let s = s.clamp(0.0, end);
    let (before, after) = (path.pose_at(s - OFF_KINKS), path.pose_at(s + OFF_KINKS));
    let is_kink = s > OFF_KINKS
        && s < end - OFF_KINKS
        && wrap_angle(after.heading - before.heading).abs() > KINK;
    if is_kink { (s + OFF_KINKS, after) } else { (s, path.pose_at(s)) }
}

fn write_object(
    xml: &mut Xml<'_>,
    Object { piece, s, line }: &Object<'_>,
) -> Result<(), ExportError> {
    let Form::Prism { shape, extent } = &piece.form else { return Ok(()) };
    let u = unit_vector(line.heading);
    let v = u.perp();
    let from_line = shape.bounds().center() - line.position;
    let is_beside = from_line.dot(u).abs() <= BESIDE;
    let t = if is_beside { from_line.dot(v) } else { 0.0 };
    let mut attributes = attributes(piece, *extent, (*s, t));
    match &**shape {
        Shape::Disc { radius, .. } if is_beside => {
            attributes.push(("radius", number(*radius)));
            xml.leaf("object", &attributes)
        }
        shape => {
            let (pivot, corners) = outline(shape);
            let origin = line.position + t * v;
            let height = number(extent.height());
            let corner = |corner: &DVec2| -> [Attribute; 4] {
                let from = pivot - origin + *corner;
                let (u, v) = (number(from.dot(u)), number(from.dot(v)));
                [("u", u), ("v", v), ("z", number(0.0)), ("height", height.clone())]
            };
            let closed = [("id", "0".into()), ("closed", "true".into())];
            xml.nest("object", &attributes, |xml| {
                xml.nest("outlines", &[], |xml| {
                    xml.nest("outline", &closed, |xml| {
                        corners.iter().try_for_each(|it| xml.leaf("cornerLocal", &corner(it)))
                    })
                })
            })
        }
    }
}

fn attributes(piece: &Piece<'_>, extent: Extent, (s, t): (f64, f64)) -> Vec<Attribute> {
    let name = piece.to_string();
    // The types are those of OpenDRIVE; the subtype is the kind as in world files.
    let kind = match piece.part.map(|part| part.kind) {
        Some(PartKind::Tree) => "tree",
        Some(PartKind::Obstacle) => "obstacle",
        _ => "barrier",
    };
    vec![
        ("id", name.clone()),
        ("name", name),
        ("type", kind.into()),
        ("subtype", piece.kind.clone()),
        ("s", number(s)),
        ("t", number(t)),
        ("zOffset", number(extent.bottom())),
        ("hdg", number(0.0)),
        ("height", number(extent.height())),
        ("orientation", "none".into()),
        ("dynamic", "no".into()),
    ]
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;

    use quick_xml::Reader;
    use quick_xml::events::Event;

    use super::*;
    use crate::curve::Curve;
    use crate::export::opendrive;
    use crate::geometry::Rect;
    use crate::pieces::LINE_THICKNESS;
    use crate::road::{Prefab, RoadSpec};
    use crate::world::{Obstacle, ObstacleKind, RoadStrip, Tree, Wall, WallKind};
    use crate::{Blueprint, Seed, Spec};

    /// An object as a reader of the file finds it: its attributes, and its corners in the world's frame.
    struct Found {
        road: usize,
        attributes: BTreeMap<String, String>,
        corners: Vec<DVec2>,
    }

    impl Found {
        fn number(&self, name: &str) -> f64 {
            self.attributes[name].parse().expect("a number")
        }

        /// The origin of its axes and the first of them, as a reader of the road's piece at `s` finds them.
        fn axes(&self, road: &RoadStrip) -> (DVec2, DVec2) {
            let pose = road.path().merged().pose_at(self.number("s"));
            let u = unit_vector(pose.heading);
            (pose.position + self.number("t") * u.perp(), u)
        }
    }

    fn objects(world: &World) -> BTreeMap<String, Found> {
        let mut file = Vec::new();
        opendrive::write(world, &mut file).expect("a road");
        let text = String::from_utf8(file).expect("text");
        let mut reader = Reader::from_str(&text);
        let mut found: BTreeMap<String, Found> = BTreeMap::new();
        let (mut last, mut road) = (String::new(), 0);
        loop {
            let (Event::Start(element) | Event::Empty(element)) = (match reader.read_event() {
                Ok(Event::Eof) => return found,
                Ok(event) => event,
                Err(error) => panic!("{error}"),
            }) else {
                continue;
            };
            let attributes: BTreeMap<String, String> = element
                .attributes()
                .map(|attribute| attribute.expect("well formed"))
                .map(|attribute| (attribute.key.as_ref().to_owned(), attribute.value.to_string()))
                .collect();
            match element.name().as_ref() {
                "road" => road = attributes["id"].parse().expect("a number"),
                "object" => {
                    last = attributes["id"].clone();
                    let known =
                        found.insert(last.clone(), Found { road, attributes, corners: vec![] });
                    assert!(known.is_none(), "{last} twice");
                }
                "cornerLocal" => {
                    let object = found.get_mut(&last).expect("an object has the corner");
                    let (origin, u) = object.axes(&world.road_strips[object.road]);
                    let [along, beside] =
                        ["u", "v"].map(|name| attributes[name].parse::<f64>().expect("a number"));
                    object.corners.push(origin + along * u + beside * u.perp());
                }
                _ => {}
            }
        }
    }

    #[test]
    fn kerbs_trees_and_obstacles_are_where_the_world_has_them() {
        let spec = RoadSpec { kerb_height: 0.15, ..Default::default() };
        let mut world = spec.generate(Seed(3)).expect("a road").to_world();
        let pose = world.road_strips[0].path().pose_at(20.0);
        let beside = pose.position + 6.0 * unit_vector(pose.heading).perp();
        let behind = world.start.expect("a start").position
            - 5.0 * unit_vector(world.start.expect("a start").heading);
        world.trees = vec![Tree::new(beside, 0.3), Tree::new(behind, 0.3)];
        let desk = Shape::Box { center: behind, half_size: DVec2::new(0.8, 0.4), heading: 0.4 };
        world.obstacles = vec![Obstacle::new(ObstacleKind::Desk, desk.clone())];
        world.obstacles[0].height = Extent::new(0.7, 0.75).ok();

        let found = objects(&world);
        assert_eq!(found.len(), world.walls.len() + 3);
        for (i, wall) in world.walls.iter().enumerate() {
            let kerb = &found[&format!("wall_{i}")];
            let attribute = |name: &str| kerb.attributes[name].as_str();
            assert_eq!(
                [attribute("type"), attribute("subtype"), attribute("height")],
                ["barrier", "kerb", "0.15"]
            );
            assert_same(&kerb.corners, &wall.shape.corners());
        }
        let tree = &found["tree_0"];
        assert!(tree.corners.is_empty());
        assert_eq!(tree.number("radius"), 0.3);
        assert!(tree.axes(&world.road_strips[0]).0.distance(beside) < 1e-9);
        // Behind the start there is no place for a middle.
        let tree = &found["tree_1"];
        assert!(tree.corners.len() >= 12);
        assert!(tree.corners.iter().all(|corner| (corner.distance(behind) - 0.3).abs() < 1e-9));
        let obstacle = &found["obstacle_0"];
        assert_same(&obstacle.corners, &desk.corners());
        assert_eq!(obstacle.number("zOffset"), 0.7);
        assert!((obstacle.number("height") - 0.05).abs() < 1e-12);
    }

    #[test]
    fn objects_belong_to_the_nearest_road_also_outside_a_corner() {
        let prefabs = vec![Prefab::Left; 4];
        let circuit = RoadSpec { prefabs, closed: true, speed: 5.0, ..Default::default() };
        let mut world = circuit.generate(Seed(2)).expect("a road").to_world();
        let far = world.bounds.max + 20.0;
        // A road with a right angle, as files of others have them.
        let corner = far + DVec2::new(30.0, 0.0);
        let line = |from: DVec2, to: DVec2| {
            let along = to - from;
            let heading = libm::atan2(along.y, along.x);
            Curve::line(Pose { position: from, heading }, along.length())
        };
        let pieces = vec![line(far, corner), line(corner, corner + DVec2::new(0.0, 25.0))];
        world.road_strips.push(RoadStrip {
            centreline: vec![],
            pieces,
            width: 4.0,
            lanes: 1,
            closed: false,
        });
        world.bounds = world.bounds.union(Rect::new(far - 10.0, far + 60.0));
        let outside = corner + DVec2::new(2.2, -2.2);
        let square = Shape::from_rect(Rect::new(outside - 0.5, outside + 0.5));
        world.walls.push(Wall::new(WallKind::Kerb, square.clone()));
        let (a, b) = (corner + DVec2::new(2.1, 3.0), corner + DVec2::new(2.1, 9.0));
        world.walls.push(Wall::new(WallKind::Wall, Shape::Segment { a, b }));

        let found = objects(&world);
        let walls = world.walls.len();
        assert_eq!(found.len(), walls);
        assert!((0..walls - 2).all(|i| found[&format!("wall_{i}")].road == 0));
        let [at_corner, beside] = [2, 1].map(|i| &found[&format!("wall_{}", walls - i)]);
        assert_eq!((at_corner.road, beside.road), (1, 1));
        assert_same(&at_corner.corners, &square.corners());
        let thick = Shape::thick_segment(a, b, LINE_THICKNESS, 0.0);
        assert_same(&beside.corners, &thick.corners());
        for (i, wall) in world.walls[..walls - 2].iter().enumerate() {
            assert_same(&found[&format!("wall_{i}")].corners, &wall.shape.corners());
        }
    }

    fn assert_same(found: &[DVec2], expected: &[DVec2]) {
        assert_eq!(found.len(), expected.len());
        for (found, expected) in found.iter().zip(expected) {
            assert!(found.distance(*expected) < 1e-9, "{found} is not {expected}");
        }
    }
}
