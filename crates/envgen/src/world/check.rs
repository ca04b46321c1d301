//! The invariants of a world, and the check of them.

use glam::DVec2;
use thiserror::Error;

use super::simple_polygon::is_simple;
use super::{MAX_WHEEL_BIAS, PartId, PartKind, RoadStrip, World, is_visible_range};
use crate::curve::{Curve, PathIndex};
use crate::geometry::{Pose, Rect, Shape, signed_area, wrap_angle};

/// The greatest distance of anything in a world from the axes of its frame, in metres. It leaves room for every
/// grid of the Earth, and coordinates up to it are exact to a hundredth of a micrometre.
pub const MAX_COORDINATE: f64 = 1e8;

/// The greatest number of lanes of a road. Files of roads contain several elements for each lane.
pub const MAX_LANES: u32 = 64;

/// Parts may extend this far beyond the bounds, in metres, which allows only for rounding.
const TOLERANCE: f64 = 1e-6;

/// The greatest gap and the greatest bend between consecutive pieces of a road, in metres and radians.
const JOINT: f64 = 1e-6;

/// The greatest distance of a road's points from its pieces, in metres.
const BESIDE: f64 = 1e-5;

/// Points of roads that turn by more than this, in radians, are not looked for everywhere.
const MOST_SEARCHED: f64 = 1e4;

/// The greatest angle, in radians, by which a piece of a road turns.
const MOST_TURNING: f64 = 1e3;

/// An invariant that a world breaks.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum Violation {
    /// The bounds are not finite, or they are empty.
    #[error("the bounds from {} to {} are not a finite rectangle", .0.min, .0.max)]
    Bounds(Rect),
    /// A coordinate or length exceeds the limits of worlds.
    #[error("`{field}` must be from -{MAX_COORDINATE:e} to {MAX_COORDINATE:e} m, got {value:e} m")]
    Extent {
        /// The field of the world.
        field: String,
        /// Its value.
        value: f64,
    },
    /// A number of a part is not finite.
    #[error("{0} holds a number that is not finite")]
    NotFinite(PartId),
    /// A size of a part is not positive, or a factor is negative.
    #[error("{0} holds a size that is not positive")]
    Size(PartId),
    /// A road has no lanes, or too many; files of roads describe every lane.
    #[error("`lanes` of {part} must be from 1 to {MAX_LANES}, got {lanes}")]
    Lanes {
        /// The road strip.
        part: PartId,
        /// Its number of lanes.
        lanes: u32,
    },
    /// A property of a part's material is not allowed.
    #[error("`{field}` of {part} must be {allowed}, got {value}")]
    Material {
        /// The part.
        part: PartId,
        /// The field that holds the property.
        field: &'static str,
        /// Its value.
        value: f64,
        /// The allowed values.
        allowed: &'static str,
    },
    /// A polygon is not simple, has fewer than three corners, or runs clockwise.
    #[error("{0} is not a simple counter-clockwise polygon")]
    Polygon(PartId),
    /// The pieces of a road do not join, or turn by more than can be computed exactly.
    #[error("the pieces of {0} do not join, or one turns by more than {MOST_TURNING} rad")]
    Pieces(PartId),
    /// A point of a road's centreline is not on its pieces, or not at their ends.
    #[error("point {point} of the centreline of {part} is not where its pieces are")]
    Centreline {
        /// The road strip.
        part: PartId,
        /// The index of the point.
        point: usize,
    },
    /// A part extends beyond the bounds.
    #[error("{0} reaches over the bounds")]
    OutOfBounds(PartId),
    /// A doorway names a room that does not exist.
    #[error("{part} names room {room}, which does not exist")]
    UnknownRoom {
        /// The doorway.
        part: PartId,
        /// The index of the room that does not exist.
        room: u32,
    },
    /// The pose of the start, the goal or a victim is not finite, or it is out of bounds.
    #[error("the {0} pose is not finite or out of bounds")]
    Pose(&'static str),
    /// The start or goal pose lies inside a solid part.
    #[error("the {pose} pose lies inside {part}")]
    Blocked {
        /// The name of the pose: `start` or `goal`.
        pose: &'static str,
        /// The part.
        part: PartId,
    },
    /// A claim of the certificate contains a number that is not finite, a negative distance, or an empty area.
    #[error("claim {0} of the certificate has a non-finite or negative distance, or an empty area")]
    Claim(usize),
    /// The sizes of the class raster do not fit together.
    #[error(
        "the class raster has {cells} cells of {cell} m, which do not fit {rows} rows of {cols}"
    )]
    Raster {
        /// Number of rows that it states.
        rows: u32,
        /// Number of columns that it states.
        cols: u32,
        /// Number of cells that it contains.
        cells: usize,
        /// Side of a cell in metres.
        cell: f64,
    },
}

impl World {
    /// Checks every invariant: numbers are finite, coordinates are at most [`MAX_COORDINATE`], sizes are positive,
    /// polygons are simple and counter-clockwise, points of roads are on their pieces, parts lie inside the bounds,
    /// doorways join rooms that exist, start and goal are in free space, claims are about finite numbers, and the
    /// raster is complete.
    ///
    /// ```
    /// use envgen::world::{PartId, PartKind, Violation};
    /// use envgen::{Blueprint, Seed, Spec, forest::ForestSpec};
    ///
    /// let mut world = ForestSpec::default().generate(Seed(7))?.to_world();
    /// assert_eq!(world.check(), Ok(()));
    /// world.trees[2].radius = -0.1;
    /// let tree = PartId { kind: PartKind::Tree, index: 2 };
    /// assert_eq!(world.check(), Err(Violation::Size(tree)));
    /// # Ok::<(), envgen::GenerateError>(())
    /// ```
    ///
    /// # Errors
    /// Returns the first invariant that does not hold.
    pub fn check(&self) -> Result<(), Violation> {
        let b = self.bounds;
        if !(b.min.is_finite() && b.max.is_finite() && b.min.cmplt(b.max).all()) {
            return Err(Violation::Bounds(b));
        }
        within("bounds.min", b.min)?;
        within("bounds.max", b.max)?;
        let rooms = numbered(PartKind::Room, self.rooms.iter().map(|room| &room.shape));
        let surfaces = numbered(PartKind::Surface, self.surfaces.iter().map(|s| &s.shape));
        let openings = numbered(PartKind::Doorway, self.doorways.iter().map(|d| &d.shape));
        for (id, shape) in rooms.chain(surfaces).chain(openings) {
            self.check_shape(id, shape)?;
        }
        for solid in self.solids() {
            self.check_shape(solid.id, &solid.shape)?;
        }
        for (id, strip) in numbered(PartKind::RoadStrip, &self.road_strips) {
            let finite = strip
                .centreline
                .iter()
                .all(|point| finite_pose(point.pose) && point.curvature.is_finite());
            if !(finite && strip.width.is_finite()) {
                return Err(Violation::NotFinite(id));
            }
            let lengths = strip.pieces.iter().map(|piece| ("length of a piece", piece.length));
            for (name, length) in lengths.chain([("width", strip.width)]) {
                within_length(length, || format!("{name} of {id}"))?;
            }
            if strip.width <= 0.0 || strip.centreline.len() < 2 {
                return Err(Violation::Size(id));
            }
            if !(1..=MAX_LANES).contains(&strip.lanes) {
                return Err(Violation::Lanes { part: id, lanes: strip.lanes });
            }
            check_pieces(id, &strip.pieces)?;
            check_centreline(id, strip)?;
            let around = Rect::around(strip.centreline.iter().map(|point| point.pose.position));
            self.check_inside(id, around.unwrap_or(b))?;
            self.check_inside(id, strip.path().bounds().unwrap_or(b))?;
        }
        for (id, surface) in numbered(PartKind::Surface, &self.surfaces) {
            if !(surface.speed.is_finite() && surface.odometry_noise.is_finite()) {
                return Err(Violation::NotFinite(id));
            }
            if surface.speed < 0.0 || surface.odometry_noise < 0.0 {
                return Err(Violation::Size(id));
            }
            if !(0.0..=MAX_WHEEL_BIAS).contains(&surface.wheel_bias) {
                return Err(Violation::Material {
                    part: id,
                    field: "wheel_bias",
                    value: surface.wheel_bias,
                    allowed: "a number from 0 to 1",
                });
            }
        }
        let walls = numbered(PartKind::Wall, self.walls.iter().map(|wall| wall.visible_range));
        let obstacles =
            numbered(PartKind::Obstacle, self.obstacles.iter().map(|o| o.visible_range));
        for (part, range) in walls.chain(obstacles) {
            if let Some(value) = range.filter(|_| !is_visible_range(range)) {
                let (field, allowed) = ("visible_range", "a positive number of metres, or absent");
                return Err(Violation::Material { part, field, value, allowed });
            }
        }
        for (id, room) in numbered(PartKind::Room, &self.rooms) {
            if room.difficulty.is_some_and(|d| !d.is_finite()) {
                return Err(Violation::NotFinite(id));
            }
        }
        for (part, door) in numbered(PartKind::Doorway, &self.doorways) {
            for room in door.rooms.into_iter().flatten() {
                if room as usize >= self.rooms.len() {
                    return Err(Violation::UnknownRoom { part, room });
                }
            }
        }
        for &victim in &self.victims {
            if !finite_pose(victim) || !b.grown(TOLERANCE).contains(victim.position) {
                return Err(Violation::Pose("victim's"));
            }
        }
        self.check_pose("start", self.start)?;
        self.check_pose("goal", self.goal)?;
        if let Some(i) = self.certificate.iter().position(|claim| !claim.is_definite()) {
            return Err(Violation::Claim(i));
        }
        self.check_raster()
    }

    fn check_shape(&self, id: PartId, shape: &Shape) -> Result<(), Violation> {
        let (finite, sized) = match shape {
            Shape::Segment { a, b } => (a.is_finite() && b.is_finite(), a != b),
            Shape::Disc { center, radius } => {
                (center.is_finite() && radius.is_finite(), *radius > 0.0)
            }
            Shape::Box { center, half_size, heading } => (
                center.is_finite() && half_size.is_finite() && heading.is_finite(),
                half_size.cmpgt(DVec2::ZERO).all(),
            ),
            Shape::Polygon { vertices } => (vertices.iter().all(|v| v.is_finite()), true),
        };
        if !finite {
            return Err(Violation::NotFinite(id));
        }
        if !sized {
            return Err(Violation::Size(id));
        }
        if let Shape::Polygon { vertices } = shape
            && !(signed_area(vertices) > 0.0 && is_simple(vertices))
        {
            return Err(Violation::Polygon(id));
        }
        self.check_inside(id, shape.bounds())
    }

    fn check_inside(&self, id: PartId, around: Rect) -> Result<(), Violation> {
        if self.bounds.grown(TOLERANCE).contains_rect(around) {
            Ok(())
        } else {
            Err(Violation::OutOfBounds(id))
        }
    }

    fn check_pose(&self, name: &'static str, pose: Option<Pose>) -> Result<(), Violation> {
        let Some(pose) = pose else { return Ok(()) };
        if !finite_pose(pose) || !self.bounds.grown(TOLERANCE).contains(pose.position) {
            return Err(Violation::Pose(name));
        }
        match self.solids().find(|solid| solid.shape.contains(pose.position)) {
            Some(solid) => Err(Violation::Blocked { pose: name, part: solid.id }),
            None => Ok(()),
        }
    }

    fn check_raster(&self) -> Result<(), Violation> {
        let Some(raster) = &self.raster else { return Ok(()) };
        let count = u64::from(raster.rows) * u64::from(raster.cols);
        let whole = count > 0 && count == raster.cells.len() as u64;
        let speeds = raster.speeds.iter().all(|speed| speed.is_finite() && *speed >= 0.0);
        let placed = raster.cell.is_finite() && raster.cell > 0.0 && raster.origin.is_finite();
        if whole && placed && speeds {
            let bounds = raster.frame().bounds();
            within("raster.origin", bounds.min)?;
            return within("raster.origin + size", bounds.max);
        }
        let (rows, cols, cells) = (raster.rows, raster.cols, raster.cells.len());
        Err(Violation::Raster { rows, cols, cells, cell: raster.cell })
    }
}

fn within(field: &str, point: DVec2) -> Result<(), Violation> {
    within_length(point.x, || format!("{field}.x"))?;
    within_length(point.y, || format!("{field}.y"))
}

/// Checks a length against the greatest coordinate. Numbers that are not finite pass, because they have errors of
/// their own.
fn within_length(value: f64, field: impl Fn() -> String) -> Result<(), Violation> {
    if value.is_finite() && value.abs() > MAX_COORDINATE {
        return Err(Violation::Extent { field: field(), value });
    }
    Ok(())
}

fn numbered<T>(
    kind: PartKind,
    parts: impl IntoIterator<Item = T>,
) -> impl Iterator<Item = (PartId, T)> {
    parts.into_iter().enumerate().map(move |(i, part)| (PartId { kind, index: i as u32 }, part))
}

fn check_pieces(id: PartId, pieces: &[Curve]) -> Result<(), Violation> {
    for piece in pieces {
        let numbers = [piece.length, piece.start_curvature, piece.end_curvature];
        if !(finite_pose(piece.start) && numbers.iter().all(|x| x.is_finite())) {
            return Err(Violation::NotFinite(id));
        }
        if piece.length <= 0.0 {
            return Err(Violation::Size(id));
        }
        if piece.length * piece.max_curvature() > MOST_TURNING {
            return Err(Violation::Pieces(id));
        }
    }
    let joined = pieces.windows(2).all(|pair| {
        let (end, start) = (pair[0].end(), pair[1].start);
        end.position.distance(start.position) <= JOINT
            && wrap_angle(end.heading - start.heading).abs() <= JOINT
    });
    if joined { Ok(()) } else { Err(Violation::Pieces(id)) }
}

/// Checks that the points of a road and its pieces are of one line: some formats hold the points, others the pieces.
fn check_centreline(id: PartId, strip: &RoadStrip) -> Result<(), Violation> {
    if strip.pieces.is_empty() {
        return Ok(());
    }
    let path = strip.path();
    let points = || strip.centreline.iter().map(|point| point.pose.position);
    let ends = [(0, 0.0), (strip.centreline.len().saturating_sub(1), path.length())];
    for (point, s) in ends.into_iter().take(if strip.closed { 1 } else { 2 }) {
        let p = points().nth(point);
        if p.is_some_and(|p| p.distance(path.pose_at(s).position) > BESIDE) {
            return Err(Violation::Centreline { part: id, point });
        }
    }
    // Each point is near the one before, unless there are few: these are looked for everywhere.
    let turning: f64 = strip.pieces.iter().map(|piece| piece.length * piece.max_curvature()).sum();
    let mut index = None;
    let (mut s, mut before) = (0.0, path.pose_at(0.0).position);
    for (point, p) in points().enumerate() {
        s = path.foot_from(s + before.distance(p), p);
        before = p;
        let is_on_path = (-BESIDE..=path.length() + BESIDE).contains(&s);
        if is_on_path && path.pose_at(s).position.distance(p) <= BESIDE {
            continue;
        }
        if turning > MOST_SEARCHED {
            return Ok(());
        }
        let index = index.get_or_insert_with(|| PathIndex::new(&path));
        match index.locate(p).filter(|located| located.offset.abs() <= BESIDE) {
            Some(located) => s = located.s,
            None => return Err(Violation::Centreline { part: id, point }),
        }
    }
    Ok(())
}

fn finite_pose(pose: Pose) -> bool {
    pose.position.is_finite() && pose.heading.is_finite()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::provenance::Provenance;
    use crate::world::Claim;
    use crate::world::{
        ClassRaster, Doorway, Obstacle, ObstacleKind, RoadPoint, Surface, SurfaceKind, Tree, Wall,
        WallKind,
    };

    fn world() -> World {
        let mut world = World::new(
            Provenance::other("manual", serde_json::Value::Null),
            Rect::new(DVec2::ZERO, DVec2::new(10.0, 5.0)),
        );
        world.trees.push(Tree::new(DVec2::new(3.0, 3.0), 1.0));
        let shape = Shape::thick_segment(DVec2::new(1.0, 1.0), DVec2::new(4.0, 1.0), 0.1, 0.0);
        world.walls.push(Wall::new(WallKind::Wall, shape));
        world.start = Some(Pose::new(0.5, 0.5, 0.0));
        world.goal = Some(Pose::new(9.0, 4.0, 1.0));
        world
    }

    fn polygon(points: &[(f64, f64)]) -> Shape {
        Shape::Polygon { vertices: points.iter().map(|&(x, y)| DVec2::new(x, y)).collect() }
    }

    fn with_obstacle(shape: Shape) -> Result<(), Violation> {
        let mut world = world();
        world.obstacles.push(Obstacle::new(ObstacleKind::Other, shape));
        world.check()
    }

    #[test]
    fn a_whole_world_passes() {
        assert_eq!(world().check(), Ok(()));
        assert_eq!(with_obstacle(polygon(&[(5., 1.), (6., 1.), (6., 2.)])), Ok(()));
    }

    #[test]
    fn roads_have_a_bounded_number_of_lanes() {
        let point = |x| RoadPoint { pose: Pose::new(x, 4.0, 0.0), curvature: 0.0 };
        let check = |lanes| {
            let mut world = world();
            world.road_strips.push(RoadStrip {
                centreline: vec![point(5.0), point(9.0)],
                pieces: Vec::new(),
                width: 1.0,
                lanes,
                closed: false,
            });
            world.check()
        };
        assert_eq!((check(1), check(MAX_LANES)), (Ok(()), Ok(())));
        for lanes in [0, MAX_LANES + 1, 1_999_988] {
            let error = check(lanes).unwrap_err().to_string();
            assert_eq!(error, format!("`lanes` of road_strip 0 must be from 1 to 64, got {lanes}"));
        }
    }

    #[test]
    fn points_of_a_road_are_where_its_pieces_are() {
        // A straight line, and a third of a circle to the left.
        let line = Curve::line(Pose::new(1.0, 3.0, 0.0), 2.0);
        let arc = Curve::arc(line.end(), 2.0, 1.0);
        let strip = |along: &[f64], by: DVec2, closed| {
            let pieces = vec![line, arc];
            let path = crate::curve::Path::new(pieces.as_slice());
            let point = |&s: &f64| {
                let pose = path.pose_at(s);
                let pose = Pose { position: pose.position + by, ..pose };
                RoadPoint { pose, curvature: path.curvature_at(s) }
            };
            let centreline = along.iter().map(point).collect();
            let mut world = world();
            let strip = RoadStrip { centreline, pieces, width: 0.5, lanes: 1, closed };
            world.road_strips.push(strip);
            world.check()
        };
        let part = PartId { kind: PartKind::RoadStrip, index: 0 };
        let off = |point| Err(Violation::Centreline { part, point });
        assert_eq!(strip(&[0.0, 0.5, 2.5, 3.0, 4.0], DVec2::ZERO, false), Ok(()));
        assert_eq!(strip(&[0.0, 4.0], DVec2::ZERO, false), Ok(()));
        assert_eq!(strip(&[0.0, 3.0], DVec2::ZERO, false), off(1));
        assert_eq!(strip(&[0.0, 3.0], DVec2::ZERO, true), Ok(()));
        assert_eq!(strip(&[0.5, 4.0], DVec2::ZERO, false), off(0));
        assert_eq!(strip(&[0.0, 4.0], DVec2::new(0.0, 2e-5), false), off(0));
        assert_eq!(strip(&[0.0, 4.5], DVec2::ZERO, true), off(1));
        let error = off(1).map_err(|error| error.to_string());
        let text = "point 1 of the centreline of road_strip 0 is not where its pieces are";
        assert_eq!(error, Err(text.to_owned()));
        // Pieces that leave the bounds.
        let mut world = world();
        let along = Curve::line(Pose::new(1.0, 4.0, 0.0), 30.0);
        let point = |pose| RoadPoint { pose, curvature: 0.0 };
        let centreline = vec![point(along.start), point(Pose::new(9.0, 4.0, 0.0))];
        let pieces = vec![along];
        world.road_strips.push(RoadStrip {
            centreline,
            pieces,
            width: 0.5,
            lanes: 1,
            closed: true,
        });
        assert_eq!(world.check(), Err(Violation::OutOfBounds(part)));
    }

    #[test]
    fn each_broken_invariant_is_named() {
        let obstacle = PartId { kind: PartKind::Obstacle, index: 0 };
        let tree = PartId { kind: PartKind::Tree, index: 0 };

        let mut broken = world();
        broken.bounds.max.x = f64::NAN;
        assert!(matches!(broken.check(), Err(Violation::Bounds(_))));

        for (value, is_within) in
            [(1e8, true), (2_147_483_647.0, false), (1.8446744073709552e19, false)]
        {
            let mut far = world();
            far.bounds.max.x = value;
            let field = "bounds.max.x".to_owned();
            let expected = if is_within { Ok(()) } else { Err(Violation::Extent { field, value }) };
            assert_eq!(far.check(), expected);
        }
        let mut far = world();
        far.bounds.min.y = -1e9;
        let error = far.check().unwrap_err().to_string();
        assert_eq!(error, "`bounds.min.y` must be from -1e8 to 1e8 m, got -1e9 m");

        let mut broken = world();
        broken.trees[0].radius = f64::INFINITY;
        assert_eq!(broken.check(), Err(Violation::NotFinite(tree)));
        broken.trees[0].radius = 0.0;
        assert_eq!(broken.check(), Err(Violation::Size(tree)));
        broken.trees[0].radius = 4.0;
        assert_eq!(broken.check(), Err(Violation::OutOfBounds(tree)));

        for outline in [
            &[(5., 1.), (6., 2.), (6., 1.)][..],
            &[(5., 1.), (6., 2.), (6., 1.), (5., 2.)],
            &[(5., 1.), (6., 1.)],
            &[(5., 1.), (7., 1.), (6., 1.), (6., 2.)],
        ] {
            assert_eq!(with_obstacle(polygon(outline)), Err(Violation::Polygon(obstacle)));
        }

        let mut broken = world();
        broken.start = Some(Pose::new(3.0, 3.5, 0.0));
        assert_eq!(broken.check(), Err(Violation::Blocked { pose: "start", part: tree }));
        broken.start = None;
        broken.goal = Some(Pose::new(30.0, 3.5, 0.0));
        assert_eq!(broken.check(), Err(Violation::Pose("goal")));

        let mut broken = world();
        let part = PartId { kind: PartKind::Doorway, index: 0 };
        let shape = Shape::from_rect(Rect::new(DVec2::ONE, DVec2::new(2.0, 2.0)));
        broken.doorways.push(Doorway::new(shape.clone(), true, [None, Some(3)]));
        assert_eq!(broken.check(), Err(Violation::UnknownRoom { part, room: 3 }));

        let mut broken = world();
        for value in [-0.1, 1.5, f64::NAN] {
            let mut broken = world();
            let shape = Shape::Disc { center: DVec2::new(7.0, 3.0), radius: 0.5 };
            let loose = Surface::new(SurfaceKind::Loose, shape);
            broken.surfaces.push(Surface { wheel_bias: value, ..loose });
            let error = broken.check().unwrap_err().to_string();
            let expected =
                format!("`wheel_bias` of surface 0 must be a number from 0 to 1, got {value}");
            assert_eq!(error, expected);
        }
        for value in [0.0, -2.0, f64::NAN, f64::INFINITY] {
            let mut broken = world();
            broken.walls[0].visible_range = Some(value);
            let error = broken.check().unwrap_err().to_string();
            let expected = format!(
                "`visible_range` of wall 0 must be a positive number of metres, or absent, got {value}"
            );
            assert_eq!(error, expected);
        }

        let kind = SurfaceKind::Water;
        broken.surfaces.push(Surface { speed: -1.0, ..Surface::new(kind, shape) });
        assert!(matches!(broken.check(), Err(Violation::Size(_))));

        let mut broken = world();
        broken.certificate = vec![Claim::TreeDistance { distance: 1.0, torus: None }];
        assert_eq!(broken.check(), Ok(()));
        let (area, crosses) = (Rect::new(DVec2::ONE, DVec2::ZERO), true);
        for claim in [
            Claim::Connected { radius: f64::NAN },
            Claim::TreeDistance { distance: -1.0, torus: None },
            Claim::CrossesWestEast { area, radius: 1.0, crosses, predicted: Some(crosses) },
        ] {
            broken.certificate.truncate(1);
            broken.certificate.push(claim);
            assert_eq!(broken.check(), Err(Violation::Claim(1)));
        }

        let mut broken = world();
        let cells = vec![1; 5];
        let raster = ClassRaster {
            rows: 2,
            cols: 3,
            cell: 1.0,
            origin: DVec2::ZERO,
            cells,
            speeds: Vec::new(),
        };
        let whole = ClassRaster { cells: vec![1; 6], cell: 1e8, ..raster.clone() };
        broken.raster = Some(raster);
        assert!(matches!(broken.check(), Err(Violation::Raster { .. })));
        broken.raster = Some(whole);
        let field = "raster.origin + size.x".to_owned();
        assert_eq!(broken.check(), Err(Violation::Extent { field, value: 3e8 }));
    }
}
