//! Optimal reciprocal collision avoidance.
//!
//! Source: J. van den Berg, S. J. Guy, M. Lin and D. Manocha, Reciprocal n-body collision avoidance, Robotics
//! Research, 2011, <https://doi.org/10.1007/978-3-642-19457-3_1>. Every other disc, and the nearest point of every
//! wall, permits a half-plane of velocities. A linear program finds the permitted velocity that is nearest to the
//! preferred one.

use glam::DVec2;

/// The time horizon in seconds for which discs avoid each other.
pub(crate) const DISC_HORIZON: f64 = 2.0;

/// The time horizon in seconds for which discs avoid walls.
pub(crate) const WALL_HORIZON: f64 = 1.0;

/// The angle in radians below which the borders of half-planes are parallel.
const PARALLEL: f64 = 1e-9;

/// A moving disc.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Disc {
    pub(crate) position: DVec2,
    pub(crate) velocity: DVec2,
    pub(crate) radius: f64,
    /// The disc's share of the effort to avoid others, in proportion to their shares; 0 for a disc that avoids nobody.
    pub(crate) share: f64,
}

/// A half-plane of velocities: those to the left of a directed line.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct HalfPlane {
    pub(crate) point: DVec2,
    /// Unit vector along the border.
    pub(crate) direction: DVec2,
}

impl HalfPlane {
    /// Creates the half-plane on the side of a border to which its unit normal points.
    fn on_side(point: DVec2, normal: DVec2) -> Self {
        HalfPlane { point, direction: -normal.perp() }
    }

    /// Returns how far a velocity is outside the half-plane; negative inside.
    #[inline]
    pub(crate) fn excess(&self, velocity: DVec2) -> f64 {
        (velocity - self.point).perp_dot(self.direction)
    }
}

/// Returns the velocities with which `me` avoids another disc for [`DISC_HORIZON`] or, if the two overlap,
/// separates from it within a step of `dt` seconds.
///
/// On no collision course, `me` may take all that is left up to one, as in the crate `dodgy_2d`, and not its share as in
/// the paper: both may then take it at once, and only avoid each other in the next decision.
pub(crate) fn avoid(me: &Disc, other: &Disc, dt: f64) -> HalfPlane {
    let to = other.position - me.position;
    let relative = me.velocity - other.velocity;
    let distance2 = to.length_squared();
    let sum = me.radius + other.radius;
    // The nearest point of the velocity obstacle's border is at `change` from the relative velocity.
    let (normal, change, is_inside) = if distance2 > sum * sum {
        let from_middle = relative - to / DISC_HORIZON;
        let along = from_middle.dot(to);
        if along < 0.0 && along * along > sum * sum * from_middle.length_squared() {
            // In front of the disc that cuts the cone off.
            let length = from_middle.length();
            let normal = from_middle / length;
            let excess = sum / DISC_HORIZON - length;
            (normal, normal * excess, excess > 0.0)
        } else {
            // Beside one of the cone's legs, which are tangents of all discs in it.
            let leg = (distance2 - sum * sum).sqrt();
            let normal = if to.perp_dot(from_middle) >= 0.0 {
                (to * leg + to.perp() * sum).perp() / distance2
            } else {
                -(to * leg - to.perp() * sum).perp() / distance2
            };
            let depth = relative.dot(normal);
            (normal, -normal * depth, depth <= 0.0)
        }
    } else {
        let from_middle = relative - to / dt;
        // Discs with the same middle and velocity part along an axis.
        let normal = from_middle.normalize_or(DVec2::X);
        (normal, normal * (sum / dt) - from_middle, true)
    };
    let share = if is_inside { me.share / (me.share + other.share) } else { 1.0 };
    HalfPlane::on_side(me.velocity + change * share, normal)
}

/// Returns the velocities with which a disc does not touch the nearest point of a wall for [`WALL_HORIZON`].
/// Velocity zero is always among them.
pub(crate) fn keep_off(position: DVec2, radius: f64, wall: DVec2) -> HalfPlane {
    let to = wall - position;
    let distance = to.length();
    let normal = if distance > 0.0 { -to / distance } else { DVec2::X };
    HalfPlane::on_side(-normal * ((distance - radius).max(0.0) / WALL_HORIZON), normal)
}

/// Returns the velocity of at most `max_speed` that all half-planes permit and that is nearest to `preferred`. If
/// no velocity is permitted, the first `walls` half-planes hold, and the greatest excess over the others is
/// minimal.
pub(crate) fn solve(planes: &[HalfPlane], walls: usize, max_speed: f64, preferred: DVec2) -> DVec2 {
    match nearest(planes, max_speed, Aim::Point(preferred)) {
        Ok(velocity) => velocity,
        Err((failed, best)) if failed < walls => best,
        Err((failed, best)) => least_excess(planes, walls, max_speed, (failed, best)),
    }
}

/// The objective of a linear program.
#[derive(Clone, Copy)]
enum Aim {
    /// The value nearest to a point.
    Point(DVec2),
    /// The value farthest in the direction of a unit vector.
    Far(DVec2),
}

/// Returns the best value in a disc and in all half-planes; otherwise the first half-plane that leaves no value,
/// and the best value for those before it.
///
/// The algorithm is incremental, as in M. de Berg et al., Computational Geometry, 2008, section 4.3,
/// <https://doi.org/10.1007/978-3-540-77974-2>, in the given order.
fn nearest(planes: &[HalfPlane], radius: f64, aim: Aim) -> Result<DVec2, (usize, DVec2)> {
    let mut best = match aim {
        Aim::Far(direction) => direction * radius,
        Aim::Point(p) if p.length_squared() > radius * radius => p.normalize_or_zero() * radius,
        Aim::Point(p) => p,
    };
    for (i, plane) in planes.iter().enumerate() {
        if plane.excess(best) > 0.0 {
            best = on_border(plane, &planes[..i], radius, aim).ok_or((i, best))?;
        }
    }
    Ok(best)
}

/// Returns the best value on the border of a half-plane, in a disc and in other half-planes.
fn on_border(plane: &HalfPlane, others: &[HalfPlane], radius: f64, aim: Aim) -> Option<DVec2> {
    let HalfPlane { point, direction } = *plane;
    let middle = -point.dot(direction);
    let half2 = middle * middle + radius * radius - point.length_squared();
    if half2 < 0.0 {
        return None;
    }
    let (mut from, mut to) = (middle - half2.sqrt(), middle + half2.sqrt());
    for other in others {
        let turn = direction.perp_dot(other.direction);
        let outside = other.direction.perp_dot(point - other.point);
        if turn.abs() <= PARALLEL {
            if outside < 0.0 {
                return None;
            }
            continue;
        }
        let at = outside / turn;
        if turn > 0.0 {
            to = to.min(at);
        } else {
            from = from.max(at);
        }
        if from > to {
            return None;
        }
    }
    let at = match aim {
        Aim::Far(wanted) if wanted.dot(direction) > 0.0 => to,
        Aim::Far(_) => from,
        Aim::Point(wanted) => (wanted - point).dot(direction).clamp(from, to),
    };
    Some(point + direction * at)
}

/// Returns the value in the first `walls` half-planes whose greatest excess over the other half-planes is least.
fn least_excess(
    planes: &[HalfPlane],
    walls: usize,
    radius: f64,
    (failed, mut best): (usize, DVec2),
) -> DVec2 {
    let mut depth = 0.0;
    let mut relaxed = Vec::new();
    for (i, plane) in planes.iter().enumerate().skip(failed) {
        if plane.excess(best) <= depth {
            continue;
        }
        // Where the excess over this half-plane is not less than that over each earlier one.
        relaxed.clear();
        relaxed.extend_from_slice(&planes[..walls]);
        for other in &planes[walls..i] {
            let turn = plane.direction.perp_dot(other.direction);
            let point = if turn.abs() <= PARALLEL {
                if plane.direction.dot(other.direction) > 0.0 {
                    continue;
                }
                0.5 * (plane.point + other.point)
            } else {
                let at = other.direction.perp_dot(plane.point - other.point) / turn;
                plane.point + plane.direction * at
            };
            let direction = (other.direction - plane.direction).normalize_or(DVec2::X);
            relaxed.push(HalfPlane { point, direction });
        }
        // Only rounding makes this fail, and then the value so far is good enough.
        if let Ok(value) = nearest(&relaxed, radius, Aim::Far(plane.direction.perp())) {
            best = value;
        }
        depth = plane.excess(best);
    }
    best
}

#[cfg(test)]
mod tests;
