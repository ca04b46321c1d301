//! Maps and scenarios of the MovingAI benchmarks.
//!
//! Format: N. R. Sturtevant, Benchmarks for grid-based pathfinding, IEEE Transactions on
//! Computational Intelligence and AI in Games 4 (2), 2012, <https://doi.org/10.1109/TCIAIG.2012.2197681>, and
//! <https://movingai.com/benchmarks/formats.html>.

use std::io::{self, Write};

use crate::landscape::metrics::{Neighbourhood, RasterError, check};
use crate::landscape::paths::TravelMap;
use crate::seed::Seed;
use crate::world::ClassRaster;

/// Writes the passable cells of a raster as a MovingAI map: `.` for plain ground, `S` (swamp) for slower ground,
/// `@` for cells that cannot be passed and for no data.
///
/// # Errors
/// When the raster's sizes do not fit together, or when writing fails.
pub fn write_map(raster: &ClassRaster, out: &mut dyn Write) -> io::Result<()> {
    check(raster).map_err(io::Error::other)?;
    write!(out, "type octile\nheight {}\nwidth {}\nmap\n", raster.rows, raster.cols)?;
    let ground: Vec<u8> = (0..=u16::MAX)
        .map(|class| match raster.speed_of(class) {
            _ if class == 0 => b'@',
            0.0 => b'@',
            speed if speed < 1.0 => b'S',
            _ => b'.',
        })
        .collect();
    for row in raster.cells.chunks(raster.cols.max(1) as usize) {
        let mut line: Vec<u8> = row.iter().map(|&class| ground[usize::from(class)]).collect();
        line.push(b'\n');
        out.write_all(&line)?;
    }
    Ok(())
}

/// A path planning task on a MovingAI map. Positions count x to the right and y down from the top left cell.
#[derive(Clone, Debug, PartialEq)]
pub struct Scenario {
    /// The task's group: a quarter of the length of the path.
    pub bucket: u32,
    /// Name of the map file.
    pub map: String,
    /// Number of columns of the map.
    pub width: u32,
    /// Number of rows of the map.
    pub height: u32,
    /// The start, as x and y.
    pub start: [u32; 2],
    /// The goal, as x and y.
    pub goal: [u32; 2],
    /// Length of the shortest path in cells, with diagonal steps of sqrt 2 that do not cut corners. All ground has
    /// the same cost.
    pub length: f64,
}

/// Draws tasks between uniformly random cells of the largest passable region, sorted by length. There are no tasks
/// if that region has fewer than two cells.
///
/// ```
/// use envgen::export::movingai::{scenarios, write_scenarios};
/// use envgen::import::read_scenarios;
/// use envgen::{Seed, Spec, landscape::LandscapeSpec};
///
/// let raster = LandscapeSpec::default().generate(Seed(7))?.to_raster();
/// let tasks = scenarios(&raster, "plain.map", 10, Seed(1))?;
/// assert!(tasks.is_sorted_by(|a, b| a.length <= b.length));
/// let mut file = Vec::new();
/// write_scenarios(&tasks, &mut file)?;
/// assert_eq!(read_scenarios(&mut file.as_slice())?.len(), 10);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// When the raster's sizes do not fit together.
pub fn scenarios(
    raster: &ClassRaster,
    map: &str,
    count: usize,
    seed: Seed,
) -> Result<Vec<Scenario>, RasterError> {
    // The lengths of the benchmarks ignore slow ground.
    let mut plain = raster.clone();
    plain.cell = 1.0;
    plain.speeds = (0..=u16::MAX)
        .map(|class| f64::from(u8::from(class > 0 && raster.speed_of(class) > 0.0)))
        .collect();
    let travel = TravelMap::new(&plain, Neighbourhood::Eight)?;
    let region = crate::landscape::largest_region(&plain);
    if region.len() < 2 {
        return Ok(Vec::new());
    }
    let (cols, width, height) = (plain.cols as usize, plain.cols, plain.rows);
    let place = |cell: usize| [(cell % cols) as u32, (cell / cols) as u32];
    let mut stream = seed.stream("landscape/scenario", 0);
    let mut draw = || region[stream.below(region.len() as u64) as usize] as usize;
    let mut tasks = Vec::new();
    while tasks.len() < count {
        let (from, to) = (draw(), draw());
        // All of a region is connected without cutting corners, as its cells share sides.
        if let Some(path) = travel.path(from, to).filter(|_| from != to) {
            tasks.push(Scenario {
                bucket: (path.cost / 4.0) as u32,
                map: map.to_owned(),
                width,
                height,
                start: place(from),
                goal: place(to),
                length: path.cost,
            });
        }
    }
    tasks.sort_by(|a, b| a.length.total_cmp(&b.length));
    Ok(tasks)
}

/// Writes tasks as a MovingAI scenario file.
///
/// # Errors
/// When writing fails.
pub fn write_scenarios(tasks: &[Scenario], out: &mut dyn Write) -> io::Result<()> {
    writeln!(out, "version 1")?;
    for task in tasks {
        let Scenario { bucket, map, width, height, start, goal, length } = task;
        let ([sx, sy], [gx, gy]) = (start, goal);
        // Columns are separated by tabs, so that a name with spaces stays one field.
        let map = map.replace(['\t', '\n', '\r'], " ");
        writeln!(out, "{bucket}\t{map}\t{width}\t{height}\t{sx}\t{sy}\t{gx}\t{gy}\t{length:.8}")?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::import::{read_map, read_scenarios};
    use glam::DVec2;

    fn raster() -> ClassRaster {
        ClassRaster {
            rows: 3,
            cols: 4,
            cell: 2.0,
            origin: DVec2::ZERO,
            cells: vec![1, 2, 2, 1, 1, 2, 0, 3, 1, 1, 1, 3],
            speeds: vec![0.0, 1.0, 0.0, 0.5],
        }
    }

    #[test]
    fn a_map_is_as_the_format_says() {
        let mut file = Vec::new();
        write_map(&raster(), &mut file).unwrap();
        let text = String::from_utf8(file).unwrap();
        assert_eq!(text, "type octile\nheight 3\nwidth 4\nmap\n.@@.\n.@@S\n...S\n");
        let back = read_map(&mut text.as_bytes()).unwrap().raster;
        let passable = |raster: &ClassRaster| -> Vec<bool> {
            raster.cells.iter().map(|&c| c > 0 && raster.speed_of(c) > 0.0).collect()
        };
        assert_eq!(passable(&back), passable(&raster()));
    }

    #[test]
    fn scenarios_have_shortest_lengths_and_come_back() {
        let tasks = scenarios(&raster(), "a map.map", 500, Seed(1)).unwrap();
        assert_eq!(tasks.len(), 500);
        let across = tasks.iter().find(|t| t.start == [0, 0] && t.goal == [3, 0]).unwrap();
        // Down two, right three, up two: the corners are blocked.
        assert_eq!(across.length, 7.0);
        assert_eq!(across.bucket, 1);
        let mut file = Vec::new();
        write_scenarios(&tasks, &mut file).unwrap();
        let back = read_scenarios(&mut file.as_slice()).unwrap();
        for (a, b) in tasks.iter().zip(&back) {
            assert!((a.length - b.length).abs() < 1e-7);
            assert_eq!(&Scenario { length: a.length, ..b.clone() }, a);
        }
    }

    #[test]
    fn without_two_cells_there_is_no_task() {
        let mut raster = raster();
        raster.speeds = vec![0.0; 4];
        assert_eq!(scenarios(&raster, "a", 5, Seed(1)), Ok(Vec::new()));
    }
}
