//! Block fields against a plain implementation of what BARN's paper and data set describe.

use envgen::cellular::{
    Acceptance, BlockField, CellularError, CellularSpec, Ends, OpenSides, c_space,
};
use envgen::certificate::{Verdict, verify};
use envgen::glam::DVec2;
use envgen::{Blueprint, Seed, Spec};
use proptest::prelude::*;

type Cells = Vec<Vec<bool>>;

/// One field with the first and last row filled, smoothed cell by cell.
fn plain_field(spec: &CellularSpec, mut chance: impl FnMut(f64) -> bool) -> (u64, Cells) {
    let (rows, cols) = (spec.rows as i64, spec.cols as i64);
    let mut map = vec![vec![true; cols as usize]; rows as usize];
    for row in &mut map[1..rows as usize - 1] {
        for cell in row {
            *cell = chance(spec.fill);
        }
    }
    let drawn = map.iter().flatten().filter(|filled| **filled).count() as u64;
    for _ in 0..spec.smoothing {
        let before = map.clone();
        for r in 0..rows {
            for c in 0..cols {
                let mut neighbours = 0;
                for (i, j) in (r - 1..=r + 1).flat_map(|i| (c - 1..=c + 1).map(move |j| (i, j))) {
                    let is_inside = i >= 0 && i < rows && j >= 0 && j < cols;
                    if is_inside && (i, j) != (r, c) {
                        neighbours += i32::from(before[i as usize][j as usize]);
                    } else if i < 0 || i >= rows {
                        neighbours += 1;
                    }
                }
                if neighbours >= 5 {
                    map[r as usize][c as usize] = true;
                } else if neighbours <= 1 {
                    map[r as usize][c as usize] = false;
                }
            }
        }
    }
    (drawn, map)
}

fn plain_c_space(map: &Cells, radius: i64) -> Cells {
    let (rows, cols) = (map.len() as i64, map[0].len() as i64);
    let blocked = |r: i64, c: i64| {
        (r - radius..=r + radius).any(|i| {
            (c - radius..=c + radius).any(|j| {
                (0..rows).contains(&i) && (0..cols).contains(&j) && map[i as usize][j as usize]
            })
        })
    };
    (0..rows).map(|r| (0..cols).map(|c| blocked(r, c)).collect()).collect()
}

/// The cells that are joined by their sides to one of them.
fn plain_region(blocked: &Cells, from: (usize, usize)) -> Vec<(usize, usize)> {
    let mut found = Vec::new();
    let mut seen = blocked.clone();
    if !std::mem::replace(&mut seen[from.0][from.1], true) {
        found.push(from);
    }
    let mut next = 0;
    while next < found.len() {
        let (r, c) = found[next];
        next += 1;
        let beside = [(r.wrapping_sub(1), c), (r + 1, c), (r, c.wrapping_sub(1)), (r, c + 1)];
        for (r, c) in beside {
            let is_inside = r < blocked.len() && c < blocked[0].len();
            if is_inside && !std::mem::replace(&mut seen[r][c], true) {
                found.push((r, c));
            }
        }
    }
    found.sort_unstable();
    found
}

/// The region in which start and goal are; `None` for a field that is not accepted.
fn plain_acceptance(blocked: &Cells) -> Option<Vec<(usize, usize)>> {
    let largest = |col: usize| {
        let mut best = Vec::new();
        for row in 0..blocked.len() {
            let region = plain_region(blocked, (row, col));
            if region.len() > best.len() {
                best = region;
            }
        }
        best
    };
    let (left, right) = (largest(0), largest(blocked[0].len() - 1));
    (!left.is_empty() && left == right).then_some(left)
}

fn rows_of(field: &BlockField, cells: &[bool]) -> Cells {
    cells.chunks(field.cols()).map(<[bool]>::to_vec).collect()
}

#[test]
fn fields_are_those_of_a_plain_implementation() {
    let mut rejected = 0;
    for (fill, smoothing, seeds) in [(0.15, 2, 8), (0.2, 4, 8), (0.25, 3, 8), (0.3, 4, 1)] {
        let spec = CellularSpec { fill, smoothing, ..Default::default() };
        for seed in (0..seeds).map(Seed) {
            let field = spec.generate(seed).unwrap();
            let mut found = None;
            for attempt in 0.. {
                let mut stream = seed.attempt("cellular/fill", 0, attempt);
                let (drawn, map) = plain_field(&spec, |p| stream.chance(p));
                let blocked = plain_c_space(&map, 2);
                if let Some(region) = plain_acceptance(&blocked) {
                    found = Some((attempt, drawn, map, blocked, region));
                    break;
                }
            }
            let (attempt, drawn, map, blocked, region) = found.unwrap();
            assert_eq!((field.rejected(), field.drawn_filled()), (attempt, drawn));
            assert_eq!(rows_of(&field, field.cells()), map, "{spec:?} {seed}");
            assert_eq!(rows_of(&field, field.c_space()), blocked, "{spec:?} {seed}");
            for (end, col) in [(field.start(), 0), (field.goal(), 29)] {
                let [row, found] = end.unwrap();
                assert_eq!(found, col);
                assert!(region.contains(&(row as usize, col as usize)));
            }
            rejected += attempt;
        }
    }
    assert!(rejected > 10, "{rejected}");
}

/// A generator of random numbers that is not the crate's: xorshift64*, G. Marsaglia and S. Vigna.
fn other_random(state: &mut u64) -> f64 {
    *state ^= *state >> 12;
    *state ^= *state << 25;
    *state ^= *state >> 27;
    (state.wrapping_mul(0x2545_F491_4F6C_DD1D) >> 11) as f64 / (1_u64 << 53) as f64
}

#[test]
fn as_many_fields_are_accepted_as_by_a_plain_implementation() {
    const FIELDS: u64 = 600;
    for (fill, smoothing) in [(0.2, 4), (0.25, 2), (0.25, 4)] {
        let spec = CellularSpec { fill, smoothing, attempts: 1, ..Default::default() };
        let first = |seed| spec.generate(Seed(seed)).is_ok();
        let ours = (0..FIELDS).filter(|&seed| first(seed)).count() as f64;
        let mut state = 0x9E37_79B9_7F4A_7C15;
        let plain = (0..FIELDS).filter(|_| {
            let (_, map) = plain_field(&spec, |p| other_random(&mut state) < p);
            plain_acceptance(&plain_c_space(&map, 2)).is_some()
        });
        let plain = plain.count() as f64;
        // Two binomial counts: 4 standard deviations are a false alarm in 16,000.
        let share = (ours + plain) / (2 * FIELDS) as f64;
        let deviation = (2.0 * FIELDS as f64 * share * (1.0 - share)).sqrt();
        assert!((ours - plain).abs() < 4.0 * deviation.max(1.0), "{fill}: {ours} and {plain}");
    }
}

#[test]
fn cells_are_filled_with_the_probability_that_is_set() {
    for fill in [0.0, 0.15, 0.3, 0.77, 1.0] {
        let spec = CellularSpec { fill, acceptance: Acceptance::All, ..Default::default() };
        let drawn = |seed| spec.generate(Seed(seed)).unwrap().drawn_filled();
        let filled: u64 = (0..100).map(|seed| drawn(seed) - 60).sum();
        let (cells, filled) = (100.0 * 28.0 * 30.0, filled as f64);
        let deviation = f64::sqrt(cells * fill * (1.0 - fill));
        assert!((filled - cells * fill).abs() <= 4.0 * deviation, "{fill}: {filled}");
    }
}

#[test]
fn starts_are_uniform_along_the_side() {
    let spec = CellularSpec { fill: 0.0, ..Default::default() };
    let mut counts = [[0_u32; 30]; 2];
    for seed in 0..2400 {
        let field = spec.generate(Seed(seed)).unwrap();
        counts[0][field.start().unwrap()[0] as usize] += 1;
        counts[1][field.goal().unwrap()[0] as usize] += 1;
    }
    for counts in counts {
        assert_eq!(counts[..3].iter().chain(&counts[27..]).sum::<u32>(), 0);
        let chi: f64 = counts[3..27]
            .iter()
            .map(|&n| (f64::from(n) - 100.0) * (f64::from(n) - 100.0) / 100.0)
            .sum();
        // 23 degrees of freedom: 56 is exceeded once in 7000.
        assert!(chi < 56.0, "{chi}");
    }
}

#[test]
fn worlds_are_their_fields_and_keep_their_promise() {
    for (open_sides, ends) in [
        (OpenSides::None, Ends::Middle),
        (OpenSides::LeftRight, Ends::Random),
        (OpenSides::All, Ends::Middle),
    ] {
        for acceptance in [Acceptance::LargestRegions, Acceptance::Crossing, Acceptance::All] {
            let spec = CellularSpec {
                rows: 20,
                fill: 0.3,
                smoothing: 2,
                robot_cells: 1,
                open_sides,
                ends,
                acceptance,
                ..Default::default()
            };
            for seed in 0..8 {
                let field = spec.generate(Seed(seed)).unwrap();
                let world = field.to_world();
                assert_eq!(world.check(), Ok(()));
                let promised = verify(&world);
                assert!(promised.iter().all(|(_, verdict)| *verdict == Verdict::Holds));
                assert!(acceptance == Acceptance::All || promised.len() == 1);
                assert_eq!(promised.is_empty(), field.metrics().path_length.is_none());
                for (i, &filled) in field.cells().iter().enumerate() {
                    let (row, col) = (i / field.cols(), i % field.cols());
                    let p = 0.15 * DVec2::new(col as f64 + 0.5, (20 - row) as f64 - 0.5);
                    let holds = world.obstacles.iter().filter(|o| o.shape.contains(p)).count();
                    assert_eq!(holds, usize::from(filled), "{row} {col}");
                }
            }
        }
    }
}

#[test]
fn a_field_has_the_same_world_for_ever() {
    let digest =
        |spec: CellularSpec| spec.generate(Seed(7)).unwrap().to_world().digest().to_string();
    assert_eq!(
        digest(CellularSpec::default()),
        "cfa0296ec1e190569dcd800f98d767947b44a541d21f49c5dad8e831da41474e"
    );
}

#[test]
fn what_cannot_be_is_named() {
    let error = |spec: CellularSpec| spec.generate(Seed(0)).unwrap_err();
    let full = CellularSpec { fill: 1.0, attempts: 20, ..Default::default() };
    assert_eq!(error(full), CellularError::Attempts { attempts: 20 });
    let text = |spec: CellularSpec| error(spec).to_string();
    let narrow = CellularSpec { rows: 6, ..Default::default() };
    assert!(text(narrow).starts_with("`rows` must be at least 7"));
    let closed = CellularSpec { cols: 6, open_sides: OpenSides::None, ..Default::default() };
    assert!(text(closed).starts_with("`cols` must be at least 7"));
    let reversed = CellularSpec { clear_to: 5, ..Default::default() };
    assert!(text(reversed).starts_with("`clear_to` must be less than fill_from, which is 5"));
    let large = CellularSpec { rows: 1024, cols: 1024, ..Default::default() };
    assert!(text(large).starts_with("`attempts` must be at most 170 for 1048576 cells"));
    let nan = CellularSpec { fill: f64::NAN, ..Default::default() };
    assert!(text(nan).starts_with("`fill` must be a number from 0 to 1, got NaN"));
}

proptest! {
    #[test]
    fn c_space_is_that_of_looking_around_each_cell(
        cells in prop::collection::vec(prop::bool::weighted(0.05), 60),
        cols in prop::sample::select(vec![1_usize, 3, 6, 10, 60]),
        radius in 0..8_usize,
    ) {
        let map: Cells = cells.chunks(cols).map(<[bool]>::to_vec).collect();
        let expected = plain_c_space(&map, radius as i64).concat();
        prop_assert_eq!(c_space(cols, &cells, radius), expected);
    }
}
