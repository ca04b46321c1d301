//! The places at which people begin, and to which they go.

use glam::DVec2;

use super::free_space::FreeSpace;
use crate::scenario::PERSON_RADIUS;
use crate::scenario::doors::DoorShape;
use crate::scenario::rooms::rooms_of_cells;
use crate::seed::Seed;
use crate::world::World;

/// The least distance in metres of a person from a doorway's middle, beyond half its width.
const OFF_DOORWAYS: f64 = 0.7;

/// The distance in metres from where robots start within which people begin only if there is no room elsewhere: the
/// radii of the largest robot and of a person.
const OFF_START: f64 = 2.0 + PERSON_RADIUS;

/// The clearance in metres from which others can mostly pass beside a place.
pub(super) const ROOMY: f64 = 0.4;

/// Distances in metres between places. The second is tried if the first gives too few places.
const SPACINGS: [f64; 2] = [1.2, 2.0 * PERSON_RADIUS + 0.1];

/// Returns the centres of cells at which people can be, at most `most`, in random order and at a distance from each
/// other. Every room is as likely as every other, and as the rest of the world, until it is full. The first places
/// are the same for every `most` for which they are enough. Places near `start` are left out if there are enough
/// others.
pub(crate) fn find_places(
    space: &FreeSpace,
    world: &World,
    doors: &[DoorShape],
    seed: Seed,
    (needed, most): (usize, usize),
    start: Option<DVec2>,
) -> Vec<DVec2> {
    let frame = space.frame;
    let usable = space.region(world.start.map(|start| start.position));
    let rooms = rooms_of_cells(world, frame);
    let mut blocked = vec![false; frame.len()];
    let mut block = |p: DVec2, radius: f64| {
        frame.touched_runs(&crate::grid::Convex::Disc(p, radius), |row, from, to| {
            blocked[row * frame.cols + from..=row * frame.cols + to].fill(true);
        });
    };
    for doorway in world.doorways.iter().filter(|doorway| doorway.open) {
        let (from, to, _) = doorway.shape.long_axis();
        block(from.midpoint(to), 0.5 * from.distance(to) + OFF_DOORWAYS);
    }
    for door in doors {
        block(door.middle(), door.reach() + PERSON_RADIUS);
    }
    let is_candidate = |cell: &usize| usable[*cell] && !blocked[*cell];
    let candidates: Vec<usize> = (0..frame.len()).filter(is_candidate).collect();
    let mut sizes = vec![0_u32; world.rooms.len() + 1];
    for &cell in &candidates {
        sizes[rooms[cell] as usize] += 1;
    }
    // Cells in the order of exponential waits at rates of one over the size of their room: a weighted
    // sample without replacement (Efraimidis and Spirakis, Information Processing Letters 97, 2006).
    let mut stream = seed.stream("scenario/people/places", 0);
    let is_at_start = |cell: usize| {
        start.is_some_and(|p| frame.center_of(cell).distance_squared(p) < OFF_START * OFF_START)
    };
    let mut order: Vec<(Rank, f64, usize)> = candidates
        .into_iter()
        .map(|cell| {
            let wait = -libm::log1p(-stream.unit()) * f64::from(sizes[rooms[cell] as usize]);
            let rank = match is_at_start(cell) {
                true => Rank::AtStart,
                false if space.cell_clearance(cell) < ROOMY => Rank::Narrow,
                false => Rank::Roomy,
            };
            (rank, wait, cell)
        })
        .collect();
    order.sort_by(|a, b| a.0.cmp(&b.0).then(a.1.total_cmp(&b.1)).then(a.2.cmp(&b.2)));
    let elsewhere = order.partition_point(|(rank, ..)| *rank < Rank::AtStart);
    let mut places = Vec::new();
    for cells in [&order[..elsewhere], &order] {
        for spacing in SPACINGS {
            places = spread(space, cells, spacing, most);
            if places.len() >= needed {
                return places;
            }
        }
    }
    places
}

/// Where a place is, the best first.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Rank {
    Roomy,
    Narrow,
    AtStart,
}

/// Returns the first cells that are at least `spacing` metres from those before them.
fn spread(
    space: &FreeSpace,
    order: &[(Rank, f64, usize)],
    spacing: f64,
    most: usize,
) -> Vec<DVec2> {
    let frame = space.frame;
    let mut taken = vec![false; frame.len()];
    let mut places = Vec::new();
    for &(_, _, cell) in order {
        if places.len() >= most {
            break;
        }
        if taken[cell] {
            continue;
        }
        let p = frame.center_of(cell);
        places.push(p);
        // Cells that the disc touches have their middle up to half a diagonal beyond it.
        let near = crate::grid::Convex::Disc(p, spacing);
        frame.touched_runs(&near, |row, from, to| {
            for col in from..=to {
                let is_near = frame.center(col, row).distance_squared(p) < spacing * spacing;
                taken[frame.index(col, row)] |= is_near;
            }
        });
    }
    places
}
