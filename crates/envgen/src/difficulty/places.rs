//! The graph of places: rooms and halls, with the passages between them.

use std::cmp::Reverse;
use std::collections::{BTreeMap, BinaryHeap};

use super::feature::features;
use super::space::{STEPS, Space};
use crate::union_find::UnionFind;

/// The share of the clearance of both places below which the clearance of a passage separates them.
const NARROW: f64 = 0.75;

/// The least area in square metres of a place, counting only the part with more clearance than its passages.
const LEAST_PLACE: f64 = 1.0;

/// The least area in square metres of ground that the robot cannot reach, so that a path around it counts as a
/// loop: walls and blocks of rooms count, but not furniture.
const LEAST_ISLAND: f64 = 4.0;

features! {
    /// The graph of places. A place is the ground around a maximum of the clearance. Two places are separate if the
    /// passage between them has less than 0.75 of the [clearance](super::Clearance) of both. They are connected by one
    /// link for each passage.
    pub struct Places {
        /// Number of places, V.
        places: u64, "";
        /// Number of links, E.
        place_links: u64, "";
        /// Independent cycles of the graph, E - V + 1.
        place_cycles: u64, "";
        /// Number of places with one link.
        place_leaves: u64, "";
        /// Mean number of links of a place.
        place_degree_mean: f64, "";
        /// Greatest number of links of a place.
        place_degree_max: u64, "";
        /// Length of the path from the place that is farthest from the start's to the one that is farthest
        /// from there, from passage to passage: the diameter, if the graph is a tree.
        place_diameter_m: f64, "m";
        /// Number of islands of 4 m^2 or more around which the robot can drive, the margin that it keeps
        /// included: loops of corridors too, which are one place.
        loops: u64, "";
        /// Mean length of the loops around islands; none without one.
        loop_length_mean_m: Option<f64>, "m";
        /// Greatest length of such a loop.
        loop_length_max_m: Option<f64>, "m";
    }
}

impl Places {
    pub(super) fn of(space: &Space<'_>, by_clearance: &[usize]) -> Self {
        let graph = Graph::new(space, by_clearance);
        let degrees = graph.degrees();
        let loops = loops(space);
        let lengths = loops.len() as f64;
        let (places, links) = (degrees.len() as u64, graph.links.len() as u64);
        Places {
            places,
            place_links: links,
            place_cycles: (links + 1).saturating_sub(places),
            place_leaves: degrees.iter().filter(|&&degree| degree == 1).count() as u64,
            place_degree_mean: 2.0 * links as f64 / places.max(1) as f64,
            place_degree_max: degrees.iter().copied().max().unwrap_or(0),
            place_diameter_m: graph.diameter(),
            loops: loops.len() as u64,
            loop_length_mean_m: (!loops.is_empty()).then(|| loops.iter().sum::<f64>() / lengths),
            loop_length_max_m: loops.iter().copied().reduce(f64::max),
        }
    }
}

/// A passage between two places.
#[derive(Clone, Copy, Debug)]
struct Link {
    places: [usize; 2],
    /// Length from the centre of one place through the passage to the centre of the other, in metres.
    length: f64,
}

struct Graph {
    /// Number of places.
    places: usize,
    /// The place that contains the start.
    start: usize,
    links: Vec<Link>,
}

impl Graph {
    /// Floods the clearance from its maxima downwards (S. Beucher and C. Lantuejoul, Use of watersheds in contour
    /// detection, 1979, <https://people.cmm.minesparis.psl.eu/users/beucher/publi/watershed.pdf>). Basins are
    /// merged if they meet where the clearance has hardly fallen, or while they are small.
    fn new(space: &Space<'_>, by_clearance: &[usize]) -> Self {
        let least = (LEAST_PLACE / space.cell_area()).ceil() as usize;
        let none = usize::MAX;
        let mut basin_of = vec![none; space.frame.len()];
        let mut sets = UnionFind::default();
        // The cell of greatest clearance of each basin, and its number of cells.
        let mut basins: Vec<(usize, usize)> = Vec::new();
        let mut near = Vec::new();
        for &cell in by_clearance {
            near.clear();
            for (_, other) in space.neighbours(cell) {
                if basin_of[other] != none {
                    near.push(sets.find(basin_of[other]));
                }
            }
            near.sort_unstable();
            near.dedup();
            let room = |basin: usize, basins: &[(usize, usize)]| space.clearance[basins[basin].0];
            let Some(mut own) =
                near.iter().copied().min_by(|&a, &b| room(b, &basins).total_cmp(&room(a, &basins)))
            else {
                basin_of[cell] = sets.push();
                basins.push((cell, 1));
                continue;
            };
            let roomiest = own;
            for &other in near.iter().filter(|&&basin| basin != roomiest) {
                let lower = room(own, &basins).min(room(other, &basins));
                let small = basins[own].1.min(basins[other].1) < least;
                if small || space.clearance[cell] >= NARROW * lower {
                    let (peak, cells) = (basins[own].0, basins[own].1 + basins[other].1);
                    sets.join(own, other);
                    own = sets.find(own);
                    basins[own] = (peak, cells);
                }
            }
            basin_of[cell] = own;
            basins[own].1 += 1;
        }
        let mut names = BTreeMap::new();
        for cell in space.cells() {
            let root = sets.find(basin_of[cell]);
            let next = names.len();
            basin_of[cell] = *names.entry(root).or_insert(next);
        }
        let mut centers = vec![0; names.len()];
        names.iter().for_each(|(&root, &name)| centers[name] = basins[root].0);
        let links = links(space, &basin_of, &centers);
        Graph { places: centers.len(), start: basin_of[space.start], links }
    }

    fn degrees(&self) -> Vec<u64> {
        let mut degrees = vec![0; self.places];
        self.links.iter().flat_map(|link| link.places).for_each(|place| degrees[place] += 1);
        degrees
    }

    fn diameter(&self) -> f64 {
        let mut beside = vec![Vec::new(); self.places];
        for link in &self.links {
            let [a, b] = link.places;
            beside[a].push((b, link.length));
            beside[b].push((a, link.length));
        }
        let (end, _) = farthest(&beside, self.start);
        farthest(&beside, end).1
    }
}

/// Returns the place that is farthest from another one, and its distance.
fn farthest(beside: &[Vec<(usize, f64)>], from: usize) -> (usize, f64) {
    let mut distance = vec![f64::INFINITY; beside.len()];
    distance[from] = 0.0;
    // The bits of non-negative numbers sort as the numbers do.
    let mut open = BinaryHeap::from([(Reverse(0_u64), from)]);
    let mut last = (from, 0.0);
    while let Some((Reverse(bits), place)) = open.pop() {
        let reached = f64::from_bits(bits);
        if reached > distance[place] {
            continue;
        }
        if reached > last.1 {
            last = (place, reached);
        }
        for &(other, length) in &beside[place] {
            if reached + length < distance[other] {
                distance[other] = reached + length;
                open.push((Reverse((reached + length).to_bits()), other));
            }
        }
    }
    last
}

/// Returns the links: the borders between two places, one link for each connected border.
fn links(space: &Space<'_>, place_of: &[usize], centers: &[usize]) -> Vec<Link> {
    // The cells of each border, on the side of the place of lower number.
    let mut borders: BTreeMap<[usize; 2], Vec<usize>> = BTreeMap::new();
    for cell in space.cells() {
        for (_, other) in space.neighbours(cell) {
            let (a, b) = (place_of[cell], place_of[other]);
            if a < b {
                let cells = borders.entry([a, b]).or_default();
                if cells.last() != Some(&cell) {
                    cells.push(cell);
                }
            }
        }
    }
    let mut links = Vec::new();
    for (places, cells) in borders {
        let mut sets = UnionFind::new(cells.len());
        for (i, &cell) in cells.iter().enumerate() {
            for (_, other) in space.neighbours(cell) {
                if let Ok(j) = cells.binary_search(&other) {
                    sets.join(i, j);
                }
            }
        }
        // The roomiest cell of each connected border.
        let mut passages: BTreeMap<usize, usize> = BTreeMap::new();
        for (i, &cell) in cells.iter().enumerate() {
            let best = passages.entry(sets.find(i)).or_insert(cell);
            if space.clearance[cell] > space.clearance[*best] {
                *best = cell;
            }
        }
        let point = |cell: usize| space.points[cell];
        links.extend(passages.into_values().map(|passage| {
            let to = |place: usize| point(centers[place]).distance(point(passage));
            Link { places, length: to(places[0]) + to(places[1]) }
        }));
    }
    links
}

/// Returns the lengths in metres of the loops around what the robot cannot reach.
fn loops(space: &Space<'_>) -> Vec<f64> {
    let frame = space.frame;
    let mut island_of = vec![0_u32; frame.len()];
    let mut loops = Vec::new();
    let mut cells = Vec::new();
    for first in 0..frame.len() {
        if space.reached[first] || island_of[first] != 0 {
            continue;
        }
        let number = first as u32 + 1;
        let mut is_inside = true;
        island_of[first] = number;
        cells.clear();
        cells.push(first);
        let mut next = 0;
        while let Some(&cell) = cells.get(next) {
            next += 1;
            let (col, row) = frame.cell(cell);
            is_inside &= col > 0 && row > 0 && col + 1 < frame.cols && row + 1 < frame.rows;
            for other in frame.neighbours(cell) {
                if !space.reached[other] && island_of[other] == 0 {
                    island_of[other] = number;
                    cells.push(other);
                }
            }
        }
        if is_inside && cells.len() as f64 * space.cell_area() >= LEAST_ISLAND {
            loops.push(perimeter(space, &island_of, &cells));
        }
    }
    loops
}

/// Returns the length of the outline of an island in metres, from the number of times that lines in four directions
/// cross it, by Crofton's formula as in C. Lang, J. Ohser and R. Hilfer, On the analysis of spatial binary
/// images, 2001.
fn perimeter(space: &Space<'_>, island_of: &[u32], cells: &[usize]) -> f64 {
    let mut crossings = [0_u64; 2];
    for &cell in cells {
        for (bit, (x, y)) in STEPS.into_iter().enumerate() {
            let beside = space.frame.neighbour(cell, x, y);
            let same = beside.is_some_and(|other| island_of[other] == island_of[cell]);
            crossings[bit % 2] += u64::from(!same);
        }
    }
    let [straight, diagonal] = crossings.map(|count| count as f64);
    let lines = straight + diagonal * std::f64::consts::FRAC_1_SQRT_2;
    std::f64::consts::PI / 8.0 * space.frame.cell_size * lines
}
