//! Generates a road from a spec and a seed.

use std::f64::consts::{PI, TAU};
use std::sync::OnceLock;

use glam::DVec2;

use super::apportion::{lengths, quantum, settle};
use super::blueprint::{Road, RoadSegment, SegmentKind};
use super::custom_laws::RoadLaws;
use super::error::RoadError;
use super::fit::{nearest_angles, nearest_lengths};
use super::part::{Part, ramp};
use super::spec::{AREA_TOLERANCE, Crossing, Lengths, MAX_WAYPOINTS, Prefab, RoadSpec};
use super::turn::TurnLimits;
use super::waypoints::{by_segment, evenly};
use crate::curve::overlap::strip_overlap;
use crate::curve::{Curve, Path};
#[cfg(feature = "rand")]
use crate::generate::Spec;
use crate::geometry::{Pose, unit_vector};
use crate::seed::Seed;
use crate::settings::Allowed;
use crate::world::RoadPoint;

/// Number of draws of the angles of a closed road, unless the whole road is drawn again.
const CLOSING_TRIES: u64 = 64;

/// An end within this distance of its target, in metres, has reached it. It is half of the promised distance.
const ON_POINT: f64 = 5e-10;

/// Generates the road of a valid spec. Distributions of the caller replace those of the spec.
pub(super) fn road(spec: &RoadSpec, seed: Seed, laws: &RoadLaws<'_>) -> Result<Road, RoadError> {
    if spec.crossing != Crossing::Resample {
        return Attempt { spec, seed, laws, number: 0 }.road();
    }
    let mut last = None;
    for number in 0..spec.attempts {
        match (Attempt { spec, seed, laws, number }).road() {
            Err(error) if error.is_chance() => last = Some(error),
            other => return other,
        }
    }
    let last = Box::new(last.unwrap_or(RoadError::OutOfArea { side: spec.area }));
    Err(RoadError::Attempts { attempts: spec.attempts, last })
}

impl RoadError {
    /// Whether another draw may succeed after this error.
    fn is_chance(&self) -> bool {
        !matches!(
            self,
            RoadError::Spec(_)
                | RoadError::LengthLaw { .. }
                | RoadError::NoLengths { .. }
                | RoadError::TurnLaw { .. }
        )
    }
}

/// One attempt to generate a road.
struct Attempt<'a> {
    spec: &'a RoadSpec,
    seed: Seed,
    laws: &'a RoadLaws<'a>,
    number: u64,
}

impl Attempt<'_> {
    fn road(&self) -> Result<Road, RoadError> {
        let spec = self.spec;
        let mut parts = self.parts()?;
        if let Some(aim) = spec.aim() {
            self.aim(&mut parts, aim)?;
        } else if spec.closed {
            self.close(&mut parts)?;
        }
        let path = self.path(&parts);
        let half = 0.5 * spec.width;
        self.check_area(&path)?;
        if spec.crossing != Crossing::Allow
            && let Some((first, second)) = strip_overlap(&path, half, spec.closed)
        {
            return Err(RoadError::Crossing { first, second });
        }
        Ok(self.build(&parts, path))
    }

    /// Draws the segments: kinds, lengths and radii.
    fn parts(&self) -> Result<Vec<Part>, RoadError> {
        let spec = self.spec;
        let kinds = self.kinds();
        let minima: Vec<f64> = match spec.lengths {
            Lengths::Reserve => {
                let (straight, turn) = (spec.reserve(false), spec.reserve(true));
                kinds.iter().map(|kind| if kind.is_turn() { turn } else { straight }).collect()
            }
            Lengths::AsPublished => vec![0.0; kinds.len()],
        };
        let mut stream = self.seed.attempt("road/lengths", 0, self.number);
        let proportions = self.laws.proportions(&spec.alpha, kinds.len(), &mut stream)?;
        let lengths = lengths(spec.length, &minima, &proportions);
        let limits = spec.turn_limits();
        kinds
            .into_iter()
            .zip(lengths)
            .enumerate()
            .map(|(i, (kind, length))| {
                if !kind.is_turn() {
                    return Ok(Part::straight(length));
                }
                let mut stream = self.seed.attempt("road/turn", i as u64, self.number);
                let radius = match self.laws.turn_share(i + 1, &mut stream)? {
                    None => limits.draw(length, spec.turn_law, &mut stream),
                    Some(share) => limits.at(length, spec.turn_law, share),
                };
                let radius = radius.ok_or_else(|| {
                    let (least, greatest) = limits.radii(length);
                    RoadError::TurnTooShort { segment: i + 1, length, least, greatest }
                })?;
                Ok(Part { kind, length, ramp: ramp(length, spec), radius })
            })
            .collect()
    }

    fn kinds(&self) -> Vec<SegmentKind> {
        let spec = self.spec;
        (0..spec.count())
            .map(|i| {
                let i = i as u64;
                let turns = || self.seed.attempt("road/random", i, self.number).chance(spec.p_turn);
                let prefab = match spec.segment_count {
                    0 => spec.prefabs[i as usize],
                    _ if turns() => Prefab::Turn,
                    _ => Prefab::Straight,
                };
                match prefab {
                    Prefab::Straight => SegmentKind::Straight,
                    Prefab::Left => SegmentKind::Left,
                    Prefab::Right => SegmentKind::Right,
                    Prefab::Turn => {
                        let bit = self.seed.attempt("road/side", i, self.number).below(2);
                        if bit == 0 { SegmentKind::Left } else { SegmentKind::Right }
                    }
                }
            })
            .collect()
    }

    /// Changes the lengths of the straights so that the road ends at a point. Angles and arcs are kept.
    fn aim(&self, parts: &mut [Part], aim: DVec2) -> Result<(), RoadError> {
        let spec = self.spec;
        let mut heading = spec.start().heading;
        let mut target = aim - spec.start().position;
        let mut columns = Vec::new();
        for part in parts.iter() {
            if part.kind.is_turn() {
                target -= part.displacement(heading);
                heading += part.angle();
            } else {
                columns.push(unit_vector(heading).to_array());
            }
        }
        let wanted: Vec<f64> =
            parts.iter().filter(|p| !p.kind.is_turn()).map(|p| p.length).collect();
        let least = vec![spec.min_segment_length; wanted.len()];
        let unreachable =
            RoadError::Unreachable { x: aim.x, y: aim.y, shortest: spec.min_segment_length };
        for _ in 0..4 {
            let Some(lengths) = nearest_lengths(&wanted, &least, &columns, target.to_array())
            else {
                break;
            };
            let straights = parts.iter_mut().filter(|part| !part.kind.is_turn());
            straights.zip(lengths).for_each(|(part, length)| part.length = length);
            self.check_length(parts)?;
            let missing = aim - end_of(&self.path(parts), spec.start()).position;
            if missing.length() <= ON_POINT {
                return Ok(());
            }
            target += missing;
        }
        Err(unreachable)
    }

    fn check_length(&self, parts: &[Part]) -> Result<(), RoadError> {
        let length: f64 = parts.iter().map(|part| part.length).sum();
        let most = match const { RoadSpec::setting("length") }.allowed {
            Allowed::Number { max, .. } => max,
            _ => f64::INFINITY,
        };
        if length > most || length / self.spec.step > MAX_WAYPOINTS as f64 {
            return Err(RoadError::TooLong { length, most, waypoints: MAX_WAYPOINTS });
        }
        Ok(())
    }

    /// Changes angles and lengths so that the road returns to its start with its initial heading.
    fn close(&self, parts: &mut [Part]) -> Result<(), RoadError> {
        let spec = self.spec;
        let limits = spec.turn_limits();
        let range = (limits.theta_min, limits.theta_max);
        let turns: Vec<usize> = (0..parts.len()).filter(|&i| parts[i].kind.is_turn()).collect();
        let signs: Vec<f64> = turns.iter().map(|&i| parts[i].kind.sign()).collect();
        let tries = if spec.crossing == Crossing::Resample { 1 } else { CLOSING_TRIES };
        for number in 0..tries {
            let angles: Vec<f64> = if number == 0 {
                turns.iter().map(|&i| parts[i].angle().abs()).collect()
            } else {
                let mut stream = self.seed.attempt("road/closing", number, self.number);
                let angle = |&i: &usize| match self.laws.turn_share(i + 1, &mut stream)? {
                    None => Ok(stream.between(range.0, range.1)),
                    Some(share) => Ok(range.0 + (range.1 - range.0) * share),
                };
                turns.iter().map(angle).collect::<Result<_, RoadError>>()?
            };
            for turning in self.whole_turns(&signs, &angles, range)? {
                if let Some(angles) = nearest_angles(&angles, &signs, range, turning)
                    && let Some(closed) = self.close_lengths(parts, &angles, &limits)
                {
                    parts.copy_from_slice(&closed);
                    return Ok(());
                }
            }
        }
        Err(RoadError::NotClosed { tries })
    }

    /// Returns the multiples of a full turn to which the angles can add up, in the order in which they are tried:
    /// first once around, as for every circuit that does not cross itself; then the others, with those nearest to
    /// the drawn angles first.
    fn whole_turns(
        &self,
        signs: &[f64],
        angles: &[f64],
        (least, most): (f64, f64),
    ) -> Result<Vec<f64>, RoadError> {
        let left = signs.iter().filter(|sign| **sign > 0.0).count() as f64;
        let right = signs.len() as f64 - left;
        let (low, high) = (left * least - right * most, left * most - right * least);
        let drawn: f64 = signs.iter().zip(angles).map(|(sign, angle)| sign * angle).sum();
        let (first, last) =
            ((low / TAU - 1e-12).ceil() as i64, (high / TAU + 1e-12).floor() as i64);
        let crosses = self.spec.crossing == Crossing::Allow;
        let mut turns: Vec<i64> =
            (first..=last).filter(|turn| crosses || turn.abs() == 1).collect();
        if turns.is_empty() {
            let (least, greatest) = (low.to_degrees(), high.to_degrees());
            return Err(RoadError::NoFullTurn { least, greatest, crosses });
        }
        let distance = |turn: i64| (turn as f64 * TAU - drawn).abs();
        turns.sort_by(|&a, &b| {
            (a.abs() != 1).cmp(&(b.abs() != 1)).then(distance(a).total_cmp(&distance(b)))
        });
        turns.truncate(4);
        // A figure of eight needs headings that differ by more than half a turn.
        if turns == [0] {
            let greatest = widest_turning(signs, (least, most));
            if greatest <= PI + 1e-12 {
                return Err(RoadError::LeadsAway { greatest: greatest.to_degrees() });
            }
        }
        Ok(turns.into_iter().map(|turn| turn as f64 * TAU).collect())
    }

    /// Solves for the lengths with given angles of the turns; `None` if there is no solution.
    fn close_lengths(
        &self,
        parts: &[Part],
        angles: &[f64],
        limits: &TurnLimits,
    ) -> Option<Vec<Part>> {
        let spec = self.spec;
        let mut angles = angles.iter();
        let angles: Vec<f64> = parts
            .iter()
            .map(|part| if part.kind.is_turn() { *angles.next().unwrap_or(&0.0) } else { 0.0 })
            .collect();
        // A turn keeps its angle, hence its shape: its displacement grows with its length.
        let of_length = |part: &Part, angle: f64, length: f64| match part.kind.is_turn() {
            false => Part::straight(length),
            true => {
                let ramp = ramp(length, spec);
                Part { length, ramp, radius: (length - ramp) / angle, ..*part }
            }
        };
        let mut heading = spec.start().heading;
        let mut columns = Vec::with_capacity(parts.len());
        let mut least = Vec::with_capacity(parts.len());
        for (part, &angle) in parts.iter().zip(&angles) {
            let unit = of_length(part, angle, 1.0);
            let along = unit.displacement(heading);
            columns.push([along.x, along.y, 1.0]);
            // Rounding must not take a radius under its limit.
            let turn = angle * limits.least_radius / limits.effective(1.0) * (1.0 + 1e-12);
            least.push(spec.min_segment_length.max(turn) + quantum(spec.length));
            heading += part.kind.sign() * angle;
        }
        let wanted: Vec<f64> = parts.iter().map(|part| part.length).collect();
        let mut target = [0.0, 0.0, spec.length];
        for _ in 0..4 {
            let mut lengths = nearest_lengths(&wanted, &least, &columns, target)?;
            settle(&mut lengths, spec.length);
            let closed: Vec<Part> = parts
                .iter()
                .zip(&angles)
                .zip(lengths)
                .map(|((part, &angle), length)| of_length(part, angle, length))
                .collect();
            let end = end_of(&self.path(&closed), spec.start());
            let missing = spec.start().position - end.position;
            if missing.length() <= ON_POINT {
                return Some(closed);
            }
            target[0] += missing.x;
            target[1] += missing.y;
        }
        None
    }

    fn path(&self, parts: &[Part]) -> Path<'static> {
        let mut pose = self.spec.start();
        let mut curves = Vec::with_capacity(parts.len());
        for part in parts {
            for curve in part.pieces(pose) {
                pose = curve.end();
                curves.push(curve);
            }
        }
        Path::new(curves)
    }

    /// Returns the distances along the road at which the segments start, and its length.
    fn starts(&self, parts: &[Part], path: &Path<'_>) -> Vec<f64> {
        let mut piece = 0;
        let mut starts = vec![0.0];
        for part in parts {
            piece += part.pieces(Pose::default()).count();
            starts.push(path.start_of(piece));
        }
        starts
    }

    fn check_area(&self, path: &Path<'_>) -> Result<(), RoadError> {
        let (side, half) = (self.spec.area, 0.5 * self.spec.width);
        if side == 0.0 {
            return Ok(());
        }
        let stations = path.stations(half, AREA_TOLERANCE);
        let inside = |p: DVec2| {
            p.min_element() >= AREA_TOLERANCE && p.max_element() <= side - AREA_TOLERANCE
        };
        let all_inside = [half, -half]
            .into_iter()
            .all(|offset| path.offset_curve(offset, &stations).into_iter().all(inside));
        if all_inside { Ok(()) } else { Err(RoadError::OutOfArea { side }) }
    }

    fn build(&self, parts: &[Part], path: Path<'static>) -> Road {
        let spec = self.spec;
        let length = if spec.aim().is_some() { path.length() } else { spec.length };
        let count = (length / spec.step).round().max(1.0) as u64;
        let step = length / count as f64;
        let starts = self.starts(parts, &path);
        let (stations, counts) = match spec.lengths {
            Lengths::Reserve => evenly(&starts, count, step),
            Lengths::AsPublished => by_segment(&starts, count),
        };
        let mut walk = path.walk();
        let waypoints = stations
            .into_iter()
            .map(|s| {
                let (pose, curvature) = walk.to(s);
                RoadPoint { pose, curvature }
            })
            .collect();
        let segments = parts
            .iter()
            .zip(&starts)
            .zip(counts)
            .map(|((part, &start), waypoints)| RoadSegment {
                kind: part.kind,
                waypoints,
                radius: part.kind.is_turn().then_some(part.radius),
                curvature: part.curvature(),
                start,
                length: part.length,
                angle: part.angle(),
            })
            .collect();
        let index = OnceLock::new();
        let (spec, seed, attempts) = (Box::new(spec.clone()), self.seed, self.number + 1);
        let edited = self.laws.any();
        Road { spec, seed, edited, attempts, length, step, segments, waypoints, path, index }
    }
}

/// Returns the greatest difference between two headings of a road whose turns have the given signs and angles
/// between `least` and `most`: the greatest sum of consecutive turns, to either side.
fn widest_turning(signs: &[f64], (least, most): (f64, f64)) -> f64 {
    let to_side = |side: f64| {
        let mut sum = 0.0_f64;
        signs.iter().fold(0.0_f64, |widest, sign| {
            sum = (sum + if sign * side > 0.0 { most } else { -least }).max(0.0);
            widest.max(sum)
        })
    };
    to_side(1.0).max(to_side(-1.0))
}

fn end_of(path: &Path<'_>, start: Pose) -> Pose {
    path.curves().last().map_or(start, Curve::end)
}

#[cfg(feature = "rand")]
impl RoadSpec {
    /// Generates a road from other distributions than the spec's. If `laws` is empty, the result is the road of
    /// [`Spec::generate`]. Otherwise the provenance cannot contain the distributions and is therefore marked as
    /// edited. All limits of the spec are kept.
    ///
    /// # Errors
    /// As [`Spec::generate`], and when a distribution gives a number that is not allowed: [`RoadError::LengthLaw`],
    /// [`RoadError::NoLengths`] or [`RoadError::TurnLaw`]. These errors end the generation even if `crossing` is
    /// `resample`.
    pub fn generate_with_laws(&self, seed: Seed, laws: &RoadLaws<'_>) -> Result<Road, RoadError> {
        self.validate()?;
        road(self, seed, laws)
    }
}
