//! The graph of pieces of ground that doors connect.

use std::collections::{BTreeMap, BTreeSet};

use crate::flood::flood;

/// The piece number of cells that belong to no piece.
const NONE: usize = usize::MAX;

/// The pieces of a grid of cells. A piece consists of cells that are connected by their sides and closed by the
/// same doors. The pieces, of which there are about as many as doors, are enough to find what is reached while a
/// door is closed.
pub(super) struct DoorGraph {
    /// The piece of each cell.
    piece_of: Vec<usize>,
    /// The doors that close each piece.
    doors: Vec<Vec<u32>>,
    /// The pieces that touch each piece.
    beside: Vec<Vec<usize>>,
}

impl DoorGraph {
    /// Creates the pieces of the open cells of a grid with `cols` columns. `closed` contains the cells that each
    /// door closes.
    pub(super) fn new(cols: usize, open: &[bool], closed: &[Vec<usize>]) -> Self {
        let mut doors_of: BTreeMap<usize, Vec<u32>> = BTreeMap::new();
        for (door, cells) in (0..).zip(closed) {
            for &cell in cells.iter().filter(|cell| open[**cell]) {
                doors_of.entry(cell).or_default().push(door);
            }
        }
        let mut graph =
            DoorGraph { piece_of: vec![NONE; open.len()], doors: Vec::new(), beside: Vec::new() };
        // Ground that no door closes.
        let mut left: Vec<bool> = open.to_vec();
        doors_of.keys().for_each(|&cell| left[cell] = false);
        for first in 0..left.len() {
            if left[first] {
                let (piece, piece_of) = (graph.doors.len(), &mut graph.piece_of);
                flood(cols, &mut left, first, |run| piece_of[run].fill(piece));
                graph.doors.push(Vec::new());
            }
        }
        // Doorways.
        let beside = |cell: usize| {
            let (left, right) = (!cell.is_multiple_of(cols), !(cell + 1).is_multiple_of(cols));
            let (above, below) = (cell + cols, cell.checked_sub(cols));
            let sides = [left.then(|| cell - 1), right.then_some(cell + 1), below, Some(above)];
            sides.into_iter().flatten().filter(|&cell| cell < open.len())
        };
        for (&first, doors) in &doors_of {
            if graph.piece_of[first] != NONE {
                continue;
            }
            let mut stack = vec![first];
            while let Some(cell) = stack.pop() {
                if graph.piece_of[cell] == NONE && doors_of.get(&cell) == Some(doors) {
                    graph.piece_of[cell] = graph.doors.len();
                    stack.extend(beside(cell));
                }
            }
            graph.doors.push(doors.clone());
        }
        // Ground that no door closes touches others at doorways alone.
        let mut links = BTreeSet::new();
        for &cell in doors_of.keys() {
            let here = graph.piece_of[cell];
            let others = beside(cell).map(|cell| graph.piece_of[cell]);
            for other in others.filter(|&other| other != NONE && other != here) {
                links.extend([(here, other), (other, here)]);
            }
        }
        graph.beside = vec![Vec::new(); graph.doors.len()];
        links.into_iter().for_each(|(from, to)| graph.beside[from].push(to));
        graph
    }

    /// Returns the number of pieces.
    pub(super) fn len(&self) -> usize {
        self.doors.len()
    }

    /// Returns the piece of a cell.
    pub(super) fn piece(&self, cell: usize) -> Option<usize> {
        self.piece_of.get(cell).copied().filter(|&piece| piece != NONE)
    }

    /// Returns which pieces are reached from a given piece while one door, or no door, is closed.
    pub(super) fn reached(&self, start: usize, closed: Option<u32>) -> Vec<bool> {
        let mut reached = vec![false; self.len()];
        let is_open = |piece: usize| closed.is_none_or(|door| !self.doors[piece].contains(&door));
        let mut stack = vec![start];
        while let Some(piece) = stack.pop() {
            if !reached[piece] && is_open(piece) {
                reached[piece] = true;
                stack.extend(&self.beside[piece]);
            }
        }
        reached
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    proptest! {
        #[test]
        fn what_is_reached_is_what_a_flood_reaches(
            open in prop::collection::vec(prop::bool::weighted(0.7), 1..120),
            cols in 1..12_usize,
            doors in prop::collection::vec((0..120_usize, 1..6_usize), 0..6),
            first: prop::sample::Index,
        ) {
            let first = first.index(open.len());
            let closed: Vec<Vec<usize>> = doors
                .iter()
                .map(|&(at, length)| (at..at + length).filter(|&cell| cell < open.len()).collect())
                .collect();
            let graph = DoorGraph::new(cols, &open, &closed);
            for door in (0..closed.len() as u32).map(Some).chain([None]) {
                let mut left = open.clone();
                if let Some(door) = door {
                    closed[door as usize].iter().for_each(|&cell| left[cell] = false);
                }
                let mut expected = vec![false; open.len()];
                flood(cols, &mut left, first, |run| expected[run].fill(true));
                let reached = graph.piece(first).map(|piece| graph.reached(piece, door));
                for (cell, &expected) in expected.iter().enumerate() {
                    let piece = graph.piece(cell);
                    let is_reached = piece.zip(reached.as_ref()).is_some_and(|(p, r)| r[p]);
                    prop_assert_eq!(is_reached, expected, "cell {} with {:?} closed", cell, door);
                }
            }
        }
    }
}
