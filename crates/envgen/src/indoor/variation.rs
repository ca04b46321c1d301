//! Rules for objects: the contents of a room are moved until its narrowest passage has a given width.
//!
//! Zwennes' future work asks for "rules that can rearrange objects inside a room to narrow or widen the paths
//! through the room".

use glam::DVec2;

use super::catalogue::{RoomDesign, SharedRoom};
use super::dimensions::{Dimensions, STEP};
use super::grid::Side;
use super::interior::{Interior, narrowest_passage};
use crate::geometry::{Shape, unit_vector, wrap_angle};
use crate::seed::Stream;

/// The greatest number of changes that are tried.
const TRIES: u32 = 80;

/// The greatest distance by which one change moves a part along each axis, in metres of the design.
pub(super) const FARTHEST_MOVE: f64 = 0.6;

/// The greatest angle by which one change turns a part, in radians.
pub(super) const GREATEST_TURN: f64 = 1.0;

/// A room whose contents were moved.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Varied {
    /// The room after the changes.
    pub(super) room: SharedRoom,
    /// The narrowest passage through the room before the changes, in metres.
    pub(super) before: f64,
    /// The narrowest passage through the room after the changes, in metres.
    pub(super) after: f64,
}

/// A distribution that may give a number that is not allowed.
type Draw<'a, E> = dyn Fn(&mut Stream) -> Result<f64, E> + 'a;

/// Moves, turns, removes and doubles obstacles until the narrowest passage through the room, as measured by
/// [`narrowest_passage`], is as near to `wanted` metres as 80 changes bring it. Walls are not moved. Doorways that
/// were clear remain clear, no free space is cut off from the doorways, and no pocket remains between parts into
/// which the footprint just fits. A room without obstacles remains as it is.
///
/// `moves` is the distribution of how far a part is moved along each axis, in metres of the design, and `turns`
/// that of the angle by which it is turned, in radians.
///
/// # Panics
/// When `wanted` is NaN or negative, and when [`Interior::new`] panics.
pub(super) fn vary<E>(
    room: &SharedRoom,
    wanted: f64,
    dimensions: Dimensions,
    stream: &mut Stream,
    moves: &Draw<'_, E>,
    turns: &Draw<'_, E>,
) -> Result<Varied, E> {
    assert!(wanted >= 0.0, "`wanted` is {wanted} m");
    let measure = |room: &RoomDesign| {
        narrowest_passage(room, dimensions.unit, dimensions.wall, dimensions.doorway)
    };
    let before = measure(room);
    let mut best = (room.clone(), before);
    let clear = clear_ports(&room.interior(dimensions), room);
    let most_cut_off = cut_off(&room.interior(dimensions), room);
    for _ in 0..TRIES {
        let (current, width) = &best;
        let error = (width - wanted).abs();
        if error <= STEP || current.obstacles.is_empty() {
            break;
        }
        let mut changed = (**current).clone();
        change(&mut changed, *width < wanted, stream, moves, turns)?;
        let Ok(changed) = SharedRoom::new(changed) else { continue };
        let width = measure(&changed);
        if (width - wanted).abs() >= error {
            continue;
        }
        let interior = changed.interior(dimensions);
        let still_clear =
            clear_ports(&interior, &changed).iter().zip(&clear).all(|(now, then)| *now || !*then);
        if still_clear
            && cut_off(&interior, &changed) <= most_cut_off
            && interior.overlooked(&changed, dimensions) == 0
        {
            best = (changed, width);
        }
    }
    Ok(Varied { room: best.0, before, after: best.1 })
}

/// Makes one change of one obstacle, of a kind that tends to widen or to narrow the passages.
fn change<E>(
    room: &mut RoomDesign,
    widen: bool,
    stream: &mut Stream,
    moves: &Draw<'_, E>,
    turns: &Draw<'_, E>,
) -> Result<(), E> {
    let which = stream.below(room.obstacles.len() as u64) as usize;
    match stream.below(4) {
        0 if widen => {
            room.obstacles.remove(which);
        }
        0 => {
            let reach = room.size() * 0.5;
            let x = stream.between(-reach.x, reach.x);
            let by = DVec2::new(x, stream.between(-reach.y, reach.y));
            let mut double = room.obstacles[which].clone();
            double.shape = moved(&double.shape, by, 0.0);
            room.obstacles.push(double);
        }
        1 => {
            let angle = turns(stream)?;
            let shape = &mut room.obstacles[which].shape;
            *shape = moved(shape, DVec2::ZERO, angle);
        }
        _ => {
            let x = moves(stream)?;
            let by = DVec2::new(x, moves(stream)?);
            let shape = &mut room.obstacles[which].shape;
            *shape = moved(shape, by, 0.0);
        }
    }
    Ok(())
}

/// Returns a shape that is moved, and turned about its middle.
fn moved(shape: &Shape, by: DVec2, angle: f64) -> Shape {
    let turn = |p: DVec2, about: DVec2| about + by + unit_vector(angle).rotate(p - about);
    match shape {
        Shape::Segment { a, b } => {
            let middle = (*a + *b) * 0.5;
            Shape::Segment { a: turn(*a, middle), b: turn(*b, middle) }
        }
        Shape::Disc { center, radius } => Shape::Disc { center: *center + by, radius: *radius },
        Shape::Box { center, half_size, heading } => Shape::Box {
            center: *center + by,
            half_size: *half_size,
            heading: wrap_angle(heading + angle),
        },
        Shape::Polygon { vertices } => {
            let middle = shape.bounds().center();
            Shape::Polygon { vertices: vertices.iter().map(|&v| turn(v, middle)).collect() }
        }
    }
}

/// Whether a doorway is possible in the middle of each side.
fn clear_ports(interior: &Interior, room: &RoomDesign) -> [bool; 4] {
    Side::ALL.map(|side| interior.port(side, room.side_length(side)).usable())
}

/// Returns the number of parts of the free space to which no doorway leads.
pub(super) fn cut_off(interior: &Interior, room: &RoomDesign) -> usize {
    let mut led_to = vec![false; interior.parts().len()];
    for side in Side::ALL {
        for at in 1..2 * room.width.max(room.height) {
            let port = interior.port(side, at);
            if let Some(part) = port.part.filter(|_| port.clear) {
                led_to[part as usize] = true;
            }
        }
    }
    led_to.iter().filter(|led_to| !**led_to).count()
}

#[cfg(test)]
mod tests;
