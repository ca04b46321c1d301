//! Worlds from GeoJSON in metres; [`export`](crate::export) describes the format.

use std::io::Read;
use std::str::FromStr;

use geojson::{
    Feature, FeatureCollection, GeoJson, GeometryValue, JsonObject, JsonValue, Position,
};
use glam::DVec2;
use serde::de::DeserializeOwned;

use super::PlanError;
use super::made_by::made_by;
use super::start::start_of_most_clearance;
use crate::file::{FileError, read_text};
use crate::geometry::{Pose, Rect, Shape, signed_area};
use crate::provenance::IMPORT;
use crate::provenance::Provenance;
use crate::world::{
    Doorway, Extent, MAX_COORDINATE, MAX_LANES, Obstacle, ObstacleKind, RoadPoint, RoadStrip, Room,
    Surface, SurfaceKind, Tree, Wall, WallKind, World, is_simple,
};

const FORMAT: &str = "GeoJSON";

/// The parts of worlds that a feature can represent.
const PARTS: [&str; 10] = [
    "start",
    "goal",
    "victim",
    "road_strip",
    "wall",
    "tree",
    "room",
    "doorway",
    "surface",
    "obstacle",
];

/// The greatest number of positions that are read.
const MAX_POSITIONS: usize = 1 << 22;

/// The greatest number of corners of a polygon with holes, which is divided into triangles.
const MAX_HOLED_CORNERS: usize = 1 << 16;

/// The greatest distance of a disc's corner from its circle, as a share of the radius.
const ON_CIRCLE: f64 = 1e-6;

/// The least height of a triangle of a polygon with holes, as a share of its longest side.
const NEEDLE: f64 = 1e-9;

/// The same as a share of the greatest coordinate: four times by how much rounding moves a corner.
const ROUNDING: f64 = 4.0 * f64::EPSILON;

/// How far in metres parts may reach over the bounds that a file states, which stay as stated.
const OVERHANG: f64 = 1e-9;

/// The margin in metres by which the bounds of a file without width or height are enlarged on all sides.
const LEAST_MARGIN: f64 = 0.5;

/// The least extent in metres of a file of another program. Less is a file in degrees.
const LEAST_EXTENT: f64 = 0.1;

/// Reads a world from features in metres.
///
/// The property `part` names the part that a feature represents, as in the files that this crate writes. Without
/// it, polygons are obstacles, lines are walls without thickness, and points with a `radius` are discs; points
/// without a radius are left out. A polygon with holes is divided into triangles. If there is no start, the point
/// of greatest clearance becomes the start.
///
/// # Errors
/// When the text is not GeoJSON, when a property has a value that is not allowed, when a file of another program has
/// no part or seems to be in degrees, or when the world breaks an invariant.
pub fn read_geojson(input: &mut dyn Read) -> Result<World, PlanError> {
    let text = read_text(input)?;
    let wrong = |error: geojson::Error| PlanError::syntax(FORMAT, error.to_string());
    let collection = match GeoJson::from_str(&text).map_err(wrong)? {
        GeoJson::FeatureCollection(collection) => collection,
        GeoJson::Feature(feature) => FeatureCollection::new([feature]),
        GeoJson::Geometry(geometry) => FeatureCollection::new([Feature::from(geometry)]),
    };
    let foreign = collection.foreign_members.unwrap_or_default();
    let made_by = made_by(foreign.get("provenance"));
    let source = serde_json::json!({ "format": "geojson", "made_by": made_by });
    let bounds = Rect::new(DVec2::ZERO, DVec2::ONE);
    let mut world = World::new(Provenance::other(IMPORT, source), bounds);
    let mut positions = MAX_POSITIONS;
    // A room with holes, or of several polygons, becomes several.
    let mut first_rooms = Vec::new();
    for (number, feature) in collection.features.iter().enumerate() {
        let properties = feature.properties.clone().unwrap_or_default();
        let feature_of = Properties { number, properties };
        let mut shapes = Vec::new();
        if let Some(geometry) = &feature.geometry {
            feature_of.shapes(&geometry.value, &mut positions, &mut shapes)?;
        }
        let rooms = world.rooms.len();
        feature_of.add(shapes, &mut world)?;
        if feature_of.part() == "room" {
            first_rooms.push((world.rooms.len() > rooms).then_some(rooms as u32));
        }
    }
    // Doorways name rooms by the order of their features.
    for (number, doorway) in world.doorways.iter_mut().enumerate() {
        for room in doorway.rooms.iter_mut().flatten() {
            let Some(Some(first)) = first_rooms.get(*room as usize) else {
                let allowed = format!("numbers of the {} rooms, or null", first_rooms.len());
                return Err(PlanError::value(
                    &format!("doorways[{number}].rooms"),
                    room.to_string(),
                    &allowed,
                ));
            };
            *room = *first;
        }
    }
    let bbox = collection.bbox.as_deref().map(|bbox| match *bbox {
        [a, b, c, d] | [a, b, _, c, d, _] => Ok(Rect::new(DVec2::new(a, b), DVec2::new(c, d))),
        _ => Err(PlanError::value("bbox", format!("{} numbers", bbox.len()), "4 or 6 numbers")),
    });
    let bbox = bbox.transpose()?;
    if !foreign.contains_key("provenance") {
        check_extent(&world)?;
    }
    world.bounds = bounds_of(&world, bbox);
    if world.start.is_none() && world.check().is_ok() {
        world.start = start_of_most_clearance(&world, false);
    }
    world.check().map_err(FileError::World)?;
    Ok(world)
}

/// Checks that a file of another program has parts, and that they are not given in degrees.
fn check_extent(world: &World) -> Result<(), PlanError> {
    if world.part_count() == 0 {
        let allowed = "one or more with a polygon, a line, or a point with a radius";
        return Err(PlanError::value("features", "none of these".to_owned(), allowed));
    }
    let size = bounds_of(world, None).size().max_element();
    if size >= LEAST_EXTENT {
        return Ok(());
    }
    let allowed = format!(
        "in metres, over {LEAST_EXTENT} m at least: project longitudes and latitudes first"
    );
    Err(PlanError::value("coordinates", format!("all within {size:.6} m"), &allowed))
}

/// Returns a rectangle around everything.
fn bounds_of(world: &World, bbox: Option<Rect>) -> Rect {
    let solids = world.walls.iter().map(|wall| wall.shape.bounds());
    let solids = solids
        .chain(
            world.trees.iter().map(|tree| Rect::new(tree.center, tree.center).grown(tree.radius)),
        )
        .chain(world.rooms.iter().map(|room| room.shape.bounds()))
        .chain(world.doorways.iter().map(|doorway| doorway.shape.bounds()))
        .chain(world.obstacles.iter().map(|obstacle| obstacle.shape.bounds()))
        .chain(world.surfaces.iter().map(|surface| surface.shape.bounds()));
    let roads = world.road_strips.iter().flat_map(|road| &road.centreline).map(|point| point.pose);
    let poses = roads.chain(world.start).chain(world.goal).chain(world.victims.iter().copied());
    let points = poses.map(|pose| Rect::new(pose.position, pose.position));
    let around = solids.chain(points).reduce(Rect::union);
    let around = match (around, bbox) {
        // Corners of parts may lie over the bounds by rounding.
        (Some(around), Some(bbox)) if over(around, bbox) <= OVERHANG => bbox,
        (Some(around), Some(bbox)) => around.union(bbox),
        (around, bbox) => around.or(bbox).unwrap_or(Rect::new(DVec2::ZERO, DVec2::ZERO)),
    };
    if around.size().min_element() > 0.0 { around } else { around.grown(LEAST_MARGIN) }
}

/// How far the first rectangle reaches over the second one.
fn over(inner: Rect, outer: Rect) -> f64 {
    (outer.min - inner.min).max(inner.max - outer.max).max_element()
}

/// The geometry of a feature.
enum Outline {
    Solid(Shape),
    Line(Vec<DVec2>),
    Point(DVec2),
}

/// The properties of a feature, and its number counted from 0, for errors.
struct Properties {
    number: usize,
    properties: JsonObject,
}

impl Properties {
    fn field(&self, name: &str) -> String {
        format!("features[{}].{name}", self.number)
    }

    /// Returns a property of a type; `None` if it is absent or null.
    fn get<T: DeserializeOwned>(&self, name: &str, allowed: &str) -> Result<Option<T>, PlanError> {
        match self.properties.get(name) {
            None | Some(JsonValue::Null) => Ok(None),
            Some(value) => serde_json::from_value(value.clone()).map(Some).map_err(|_| {
                let text: String = value.to_string().chars().take(60).collect();
                PlanError::value(&self.field(&format!("properties.{name}")), text, allowed)
            }),
        }
    }

    /// Returns a property of a shape, which files of other programs may use for anything.
    fn shape<T: DeserializeOwned>(
        &self,
        name: &str,
        allowed: &str,
    ) -> Result<Option<T>, PlanError> {
        match self.get(name, allowed) {
            Err(_) if self.part().is_empty() => Ok(None),
            found => found,
        }
    }

    fn number(&self, name: &str) -> Result<Option<f64>, PlanError> {
        self.get(name, "a number")
    }

    fn shapes(
        &self,
        geometry: &GeometryValue,
        left: &mut usize,
        found: &mut Vec<Outline>,
    ) -> Result<(), PlanError> {
        let mut points = |line: &[Position]| self.points(line, left);
        match geometry {
            GeometryValue::Point { coordinates } => {
                let at = points(std::slice::from_ref(coordinates))?;
                found.extend(at.into_iter().map(Outline::Point));
            }
            GeometryValue::MultiPoint { coordinates } => {
                found.extend(points(coordinates)?.into_iter().map(Outline::Point));
            }
            GeometryValue::LineString { coordinates } => {
                found.push(Outline::Line(points(coordinates)?));
            }
            GeometryValue::MultiLineString { coordinates } => {
                for line in coordinates {
                    found.push(Outline::Line(points(line)?));
                }
            }
            GeometryValue::Polygon { coordinates } => self.polygon(coordinates, left, found)?,
            GeometryValue::MultiPolygon { coordinates } => {
                for polygon in coordinates {
                    self.polygon(polygon, left, found)?;
                }
            }
            GeometryValue::GeometryCollection { geometries } => {
                for geometry in geometries {
                    self.shapes(&geometry.value, left, found)?;
                }
            }
        }
        Ok(())
    }

    fn points(&self, line: &[Position], left: &mut usize) -> Result<Vec<DVec2>, PlanError> {
        let rest = left.checked_sub(line.len());
        *left = rest.ok_or_else(|| {
            let allowed = format!("at most {MAX_POSITIONS} positions in the file");
            PlanError::value(&self.field("geometry"), "more positions", allowed)
        })?;
        let point = |position: &Position| match position.as_slice() {
            [x, y, ..] if x.is_finite() && y.is_finite() => Ok(DVec2::new(*x, *y)),
            other => {
                let value = format!("{other:?}");
                Err(PlanError::value(&self.field("geometry"), value, "two finite coordinates"))
            }
        };
        line.iter().map(point).collect()
    }

    fn polygon(
        &self,
        rings: &[Vec<Position>],
        left: &mut usize,
        found: &mut Vec<Outline>,
    ) -> Result<(), PlanError> {
        let mut outlines = Vec::new();
        for ring in rings {
            let mut ring = self.points(ring, left)?;
            ring.dedup();
            if ring.len() > 1 && ring.first() == ring.last() {
                ring.pop();
            }
            if ring.len() < 3 {
                let allowed = "three different corners or more";
                return Err(PlanError::value(&self.field("geometry"), ring.len(), allowed));
            }
            outlines.push(ring);
        }
        let Some(outer) = outlines.first() else { return Ok(()) };
        if outlines.len() > 1 {
            let corners = outlines.iter().map(Vec::len).sum::<usize>();
            if corners > MAX_HOLED_CORNERS {
                let allowed = format!("at most {MAX_HOLED_CORNERS} corners with holes");
                return Err(PlanError::value(&self.field("geometry"), corners, allowed));
            }
            found.extend(triangles(&outlines).map(Outline::Solid));
            return Ok(());
        }
        if let Some(disc) = self.disc(outer)? {
            found.push(Outline::Solid(disc));
            return Ok(());
        }
        let mut vertices = outlines.swap_remove(0);
        if signed_area(&vertices) < 0.0 {
            vertices.reverse();
        }
        if !is_simple(&vertices) {
            let allowed = "a polygon whose sides neither cross nor touch each other";
            return Err(PlanError::value(&self.field("geometry"), "another polygon", allowed));
        }
        found.push(Outline::Solid(Shape::Polygon { vertices }));
        Ok(())
    }

    /// Returns the disc that a polygon represents; `None` if single corners were moved.
    fn disc(&self, corners: &[DVec2]) -> Result<Option<Shape>, PlanError> {
        let center: Option<[f64; 2]> = self.shape("center", "two numbers")?;
        let radius: Option<f64> = self.shape("radius", "a number")?;
        let (Some(center), Some(radius)) = (center, radius) else {
            return Ok(None);
        };
        // Programs that move a polygon leave its properties as they were.
        let middle = corners.iter().sum::<DVec2>() / corners.len() as f64;
        let found = [DVec2::from_array(center), middle].into_iter().find(|center| {
            let off = |corner: &DVec2| (corner.distance(*center) - radius).abs();
            corners.iter().all(|corner| off(corner) <= ON_CIRCLE * radius)
        });
        Ok(found.map(|center| Shape::Disc { center, radius }))
    }

    /// Returns the part that the feature represents; an empty name for files of other programs.
    fn part(&self) -> &str {
        let part = self.properties.get("part").and_then(JsonValue::as_str).unwrap_or_default();
        if PARTS.contains(&part) { part } else { "" }
    }

    /// Returns the error for a part whose geometry is not of the required type.
    fn wrong_geometry(&self, allowed: &str) -> PlanError {
        PlanError::value(
            &self.field("geometry"),
            format!("another shape of a {}", self.part()),
            allowed,
        )
    }

    fn add(&self, outlines: Vec<Outline>, world: &mut World) -> Result<(), PlanError> {
        let part = self.part();
        let heading = match part {
            "start" | "goal" | "victim" => self.number("heading")?.unwrap_or(0.0),
            _ => 0.0,
        };
        for outline in outlines {
            match (part, outline) {
                ("start", Outline::Point(at)) => world.start = Some(Pose { position: at, heading }),
                ("goal", Outline::Point(at)) => world.goal = Some(Pose { position: at, heading }),
                ("victim", Outline::Point(at)) => {
                    world.victims.push(Pose { position: at, heading })
                }
                ("road_strip", Outline::Line(line)) => self.add_road(&line, world)?,
                ("start" | "goal" | "victim", _) => return Err(self.wrong_geometry("a point")),
                ("road_strip", _) => return Err(self.wrong_geometry("a line")),
                (_, Outline::Point(center)) => {
                    // Of files of others only what can be one.
                    let is_radius = |radius: &f64| {
                        !part.is_empty() || (*radius > 0.0 && *radius <= MAX_COORDINATE)
                    };
                    if let Some(radius) = self.shape("radius", "a number")?.filter(is_radius) {
                        self.add_shape(part, Shape::Disc { center, radius }, world)?;
                    } else if !part.is_empty() {
                        let field = self.field("properties.radius");
                        return Err(PlanError::value(
                            &field,
                            "null",
                            "the radius of a point in metres",
                        ));
                    }
                }
                (_, Outline::Line(line)) => {
                    for pair in line.windows(2).filter(|pair| pair[0] != pair[1]) {
                        let shape = Shape::Segment { a: pair[0], b: pair[1] };
                        match part {
                            "" => world.walls.push(Wall::new(WallKind::Wall, shape)),
                            part => self.add_shape(part, shape, world)?,
                        }
                    }
                }
                (_, Outline::Solid(shape)) => self.add_shape(part, shape, world)?,
            }
        }
        Ok(())
    }

    fn add_shape(&self, part: &str, shape: Shape, world: &mut World) -> Result<(), PlanError> {
        if part.is_empty() {
            // Files of others have properties of their own, of which nothing is asked.
            world.obstacles.push(Obstacle::new(ObstacleKind::Other, shape));
            return Ok(());
        }
        let visible_range = self.number("visible_range")?;
        let height: Option<Extent> = self.get("height", "a bottom and a top in metres")?;
        // Files state all heights, parts those that are not usual.
        let unusual = |usual: Extent| height.filter(|height| *height != usual);
        match (part, shape) {
            ("wall", shape) => {
                let kind = self.get("kind", "a kind of wall")?.unwrap_or(WallKind::Wall);
                let plain = Wall::new(kind, shape);
                let height = unusual(plain.extent());
                world.walls.push(Wall { visible_range, height, ..plain });
            }
            ("tree", Shape::Disc { center, radius }) => {
                let plain = Tree::new(center, radius);
                world.trees.push(Tree { height: unusual(plain.extent()), ..plain });
            }
            ("room", shape) => {
                let plain = Room {
                    name: self.get("name", "a text")?.unwrap_or_default(),
                    shape,
                    difficulty: self.number("difficulty")?,
                    lit: self.get("lit", "true or false")?.unwrap_or(true),
                    contents: self.get("contents", "what is left of a room")?.unwrap_or_default(),
                    height: None,
                };
                world.rooms.push(Room { height: unusual(plain.extent()), ..plain });
            }
            ("doorway", shape) => {
                let open = self.get("open", "true or false")?.unwrap_or(true);
                let rooms = self.get("rooms", "two numbers of rooms, or null")?.unwrap_or_default();
                let plain = Doorway::new(shape, open, rooms);
                world.doorways.push(Doorway { height: unusual(plain.extent()), ..plain });
            }
            ("surface", shape) => {
                let kind = self.get("kind", "a kind of surface")?.unwrap_or(SurfaceKind::Uneven);
                let plain = Surface::new(kind, shape);
                world.surfaces.push(Surface {
                    speed: self.number("speed")?.unwrap_or(plain.speed),
                    odometry_noise: self.number("odometry_noise")?.unwrap_or(plain.odometry_noise),
                    wheel_bias: self.number("wheel_bias")?.unwrap_or(plain.wheel_bias),
                    height: unusual(plain.extent()),
                    ..plain
                });
            }
            ("obstacle", shape) => {
                let kind = self.get("kind", "a kind of obstacle")?.unwrap_or(ObstacleKind::Other);
                let plain = Obstacle::new(kind, shape);
                let height = unusual(plain.extent());
                world.obstacles.push(Obstacle { visible_range, height, ..plain });
            }
            // A tree whose corners were moved.
            (_, shape) => {
                let plain = Obstacle::new(ObstacleKind::Other, shape);
                let height = unusual(plain.extent());
                world.obstacles.push(Obstacle { visible_range, height, ..plain });
            }
        }
        Ok(())
    }

    /// Adds a road. A line that ends at its first point is a closed road, unless the property `closed` says otherwise.
    fn add_road(&self, line: &[DVec2], world: &mut World) -> Result<(), PlanError> {
        let mut line = line.to_vec();
        line.dedup();
        if line.len() < 2 {
            let allowed = "a line with at least two different points";
            return Err(PlanError::value(&self.field("geometry"), "a point".to_owned(), allowed));
        }
        let meets = line.len() > 3 && line.first() == line.last();
        let closed = self.get("closed", "true or false")?.unwrap_or(meets);
        if closed && line.len() > 2 && line.first() == line.last() {
            line.pop();
        }
        let heading = |i: usize| {
            let pair = match i + 1 < line.len() {
                true => [i, i + 1],
                false if closed => [i, 0],
                false => [i - 1, i],
            };
            let along = line[pair[1]] - line[pair[0]];
            libm::atan2(along.y, along.x)
        };
        let point = |i: usize| RoadPoint {
            pose: Pose { position: line[i], heading: heading(i) },
            curvature: 0.0,
        };
        let lanes = format!("a whole number from 1 to {MAX_LANES}");
        world.road_strips.push(RoadStrip {
            centreline: (0..line.len()).map(point).collect(),
            pieces: Vec::new(),
            width: self.number("width")?.unwrap_or(1.0),
            lanes: self.get("lanes", &lanes)?.unwrap_or(1),
            closed,
        });
        Ok(())
    }
}

/// Returns the triangles of a polygon with holes, counter-clockwise. It does not use `mesh::triangulate`, which
/// refuses holes that touch the outline or each other.
fn triangles(rings: &[Vec<DVec2>]) -> impl Iterator<Item = Shape> {
    let corners: Vec<DVec2> = rings.concat();
    let starts = rings.iter().scan(0, |next, ring| {
        *next += ring.len();
        Some(*next as u32)
    });
    let holes: Vec<u32> = starts.take(rings.len() - 1).collect();
    let mut indices: Vec<u32> = Vec::new();
    earcut::Earcut::new().earcut(corners.iter().map(|p| p.to_array()), &holes, &mut indices);
    let triangles: Vec<Shape> = indices
        .chunks_exact(3)
        .map(|triangle| {
            let mut vertices: Vec<_> = triangle.iter().map(|&i| corners[i as usize]).collect();
            if signed_area(&vertices) < 0.0 {
                vertices.swap(1, 2);
            }
            vertices
        })
        .filter(|vertices| !is_needle(vertices))
        .map(|vertices| Shape::Polygon { vertices })
        .collect();
    triangles.into_iter()
}

/// Whether the corners of a triangle lie on one line but for rounding, as those of nodes on a straight side do.
fn is_needle(corners: &[DVec2]) -> bool {
    let sides = (0..3).map(|i| corners[i].distance(corners[(i + 1) % 3]));
    let longest = sides.fold(0.0, f64::max);
    let farthest = corners.iter().map(|p| p.abs().max_element()).fold(0.0, f64::max);
    let least = (NEEDLE * longest).max(ROUNDING * farthest);
    // Twice the area is the longest side times the height on it; corners that coincide have neither.
    2.0 * signed_area(corners) <= least * longest
}
