//! What is solid in a world with roads, as objects of ASAM OpenDRIVE: kerbs, closed doors, trees and obstacles, each
//! with its bottom and top.
//!
//! An object belongs to the road whose reference line is nearest to its middle. Its local axes have their origin there,
//! beside that line or on its end, and the heading of the line.

use std::f64::consts::TAU;

use glam::DVec2;

use super::ExportError;
use super::xml::{Attribute, Xml, number};
use crate::curve::{Located, PathIndex};
use crate::geometry::{Shape, unit_vector};
use crate::pieces::{Form, LINE_THICKNESS, Piece, pieces};
use crate::world::{PartKind, World};

/// Corners of a disc beyond the end of a road: only beside a road is there a place for its middle.
const CORNERS: u32 = 32;

/// In metres: what is nearer to the normal of the reference line is beside it.
const BESIDE: f64 = 1e-9;

/// The solid pieces of a world, by road.
pub(super) struct RoadObjects<'a>(Vec<Vec<(Piece<'a>, Located)>>);

impl<'a> RoadObjects<'a> {
    pub(super) fn of(world: &'a World) -> Self {
        let indices: Vec<PathIndex> =
            world.road_strips.iter().map(|strip| PathIndex::new(&strip.path())).collect();
        let mut roads: Vec<_> = indices.iter().map(|_| Vec::new()).collect();
        for piece in pieces(world).into_iter().filter(|piece| piece.is_solid) {
            let Form::Prism { shape, .. } = &piece.form else { continue };
            let middle = shape.bounds().center();
            let nearest = indices
                .iter()
                .enumerate()
                .filter_map(|(road, index)| Some((road, index.locate(middle)?)))
                .min_by(|a, b| a.1.offset.abs().total_cmp(&b.1.offset.abs()));
            if let Some((road, located)) = nearest {
                roads[road].push((piece, located));
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
            self.0[road].iter().try_for_each(|(piece, located)| object(xml, piece, located))
        })
    }
}

fn object(xml: &mut Xml<'_>, piece: &Piece<'_>, located: &Located) -> Result<(), ExportError> {
    let Form::Prism { shape, extent } = &piece.form else { return Ok(()) };
    let u = unit_vector(located.pose.heading);
    let v = u.perp();
    let from_line = shape.bounds().center() - located.pose.position;
    let is_beside = from_line.dot(u).abs() <= BESIDE;
    let t = if is_beside { located.offset } else { 0.0 };
    let origin = located.pose.position + t * v;
    let name = piece.to_string();
    let mut attributes = vec![
        ("id", name.clone()),
        ("name", name),
        ("type", object_type(piece).into()),
        ("subtype", piece.kind.clone()),
        ("s", number(located.s)),
        ("t", number(t)),
        ("zOffset", number(extent.bottom())),
        ("hdg", number(0.0)),
        ("height", number(extent.height())),
        ("orientation", "none".into()),
        ("dynamic", "no".into()),
    ];
    let corners = match &**shape {
        Shape::Disc { radius, .. } if is_beside => {
            attributes.push(("radius", number(*radius)));
            return xml.leaf("object", &attributes);
        }
        Shape::Disc { center, radius } => (0..CORNERS)
            .map(|i| *center + *radius * unit_vector(TAU * f64::from(i) / f64::from(CORNERS)))
            .collect(),
        Shape::Segment { a, b } => Shape::thick_segment(*a, *b, LINE_THICKNESS, 0.0).corners(),
        Shape::Box { .. } | Shape::Polygon { .. } => shape.corners(),
    };
    let height = number(extent.height());
    let local = |corner: DVec2| -> [Attribute; 4] {
        let from = corner - origin;
        [
            ("u", number(from.dot(u))),
            ("v", number(from.dot(v))),
            ("z", number(0.0)),
            ("height", height.clone()),
        ]
    };
    xml.nest("object", &attributes, |xml| {
        xml.nest("outlines", &[], |xml| {
            xml.nest("outline", &[("id", "0".into()), ("closed", "true".into())], |xml| {
                corners.iter().try_for_each(|&corner| xml.leaf("cornerLocal", &local(corner)))
            })
        })
    })
}

/// The type among those of OpenDRIVE; the subtype is the kind as in world files.
fn object_type(piece: &Piece<'_>) -> &'static str {
    match piece.part.map(|part| part.kind) {
        Some(PartKind::Tree) => "tree",
        Some(PartKind::Obstacle) => "obstacle",
        _ => "barrier",
    }
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;

    use quick_xml::Reader;
    use quick_xml::events::Event;

    use super::*;
    use crate::export::opendrive;
    use crate::road::RoadSpec;
    use crate::world::{Extent, Obstacle, ObstacleKind, Tree};
    use crate::{Blueprint, Seed, Spec};

    /// An object as a reader of the file finds it: its attributes, and its corners in the world's frame.
    struct Found {
        attributes: BTreeMap<String, String>,
        corners: Vec<DVec2>,
    }

    impl Found {
        fn number(&self, name: &str) -> f64 {
            self.attributes[name].parse().expect("a number")
        }

        fn origin(&self, world: &World) -> (DVec2, DVec2) {
            let pose = world.road_strips[0].path().pose_at(self.number("s"));
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
        let mut last = String::new();
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
                "object" => {
                    last = attributes["id"].clone();
                    found.insert(last.clone(), Found { attributes, corners: vec![] });
                }
                "cornerLocal" => {
                    let object = found.get_mut(&last).expect("an object has the corner");
                    let (origin, u) = object.origin(world);
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
        assert!(tree.origin(&world).0.distance(beside) < 1e-9);
        // Behind the start there is no place for a middle.
        let tree = &found["tree_1"];
        assert_eq!(tree.corners.len(), CORNERS as usize);
        assert!(tree.corners.iter().all(|corner| (corner.distance(behind) - 0.3).abs() < 1e-9));
        let obstacle = &found["obstacle_0"];
        assert_same(&obstacle.corners, &desk.corners());
        assert_eq!(obstacle.number("zOffset"), 0.7);
        assert!((obstacle.number("height") - 0.05).abs() < 1e-12);
    }

    fn assert_same(found: &[DVec2], expected: &[DVec2]) {
        assert_eq!(found.len(), expected.len());
        for (found, expected) in found.iter().zip(expected) {
            assert!(found.distance(*expected) < 1e-9, "{found} is not {expected}");
        }
    }
}
