//! MovingAI maps and scenarios; [`export::movingai`](crate::export::movingai) describes the format.

use std::io::Read;

use glam::DVec2;

use super::raster::{CellValues, ImportedRaster, RasterFileError, check_size};
use crate::export::movingai::Scenario;
use crate::file;

/// The classes of a map's terrain, with their letters and the factor on a robot's speed: ground, swamp, water,
/// trees, and out of bounds. In the benchmarks, an agent can pass the first two.
const TERRAIN: [(&str, f64); 5] = [(".G", 1.0), ("S", 0.5), ("W", 0.0), ("T", 0.0), ("@O", 0.0)];

/// Reads a MovingAI map as classes: 1 ground (`.`, `G`), 2 swamp (`S`), 3 water (`W`), 4 trees (`T`), 5 out of
/// bounds (`@`, `O`). Ground has the speed 1, swamp 0.5, the other classes 0. A cell has a side of 1 m.
///
/// ```
/// use envgen::import::read_map;
///
/// let text = "type octile\nheight 2\nwidth 3\nmap\n..@\n.S.\n";
/// let raster = read_map(&mut text.as_bytes())?.raster;
/// assert_eq!(raster.cells, [1, 1, 5, 1, 2, 1]);
/// let speeds = [1, 2, 5].map(|class| raster.speed_of(class));
/// assert_eq!(speeds, [1.0, 0.5, 0.0]);
/// # Ok::<(), envgen::import::RasterFileError>(())
/// ```
///
/// # Errors
/// Names the line that contains the mistake.
pub fn read_map(input: &mut dyn Read) -> Result<ImportedRaster, RasterFileError> {
    let text = file::read_text(input)?;
    let wrong = |line: usize, what: String| RasterFileError::Line { line, what };
    let (mut height, mut width) = (None, None);
    let mut lines = (1..).zip(text.lines());
    loop {
        let Some((number, line)) = lines.next() else {
            return Err(wrong(1, "there is no line `map`".to_owned()));
        };
        let mut words = line.split_whitespace();
        let (key, word) = (words.next().unwrap_or_default(), words.next().unwrap_or_default());
        let size = || {
            let wrong = || wrong(number, format!("`{key}` must be a whole number, got `{word}`"));
            word.parse::<u64>().map_err(|_| wrong())
        };
        match key {
            "type" => {}
            "height" => height = Some(size()?),
            "width" => width = Some(size()?),
            "map" => break,
            _ => return Err(wrong(number, format!("`{line}` before the line `map`"))),
        }
    }
    let missing = |key: &str| wrong(1, format!("there is no line `{key}`"));
    let rows = height.ok_or_else(|| missing("height"))?;
    let cols = width.ok_or_else(|| missing("width"))?;
    check_size(rows, cols)?;
    let mut values = CellValues::default();
    for (number, line) in lines {
        if line.is_empty() && values.len() == rows * cols {
            continue;
        }
        let before = values.len();
        for letter in line.chars() {
            let class = (1..).zip(TERRAIN).find(|(_, terrain)| terrain.0.contains(letter));
            let class = class.ok_or_else(|| {
                let terrains: String = TERRAIN.iter().map(|terrain| terrain.0).collect();
                wrong(number, format!("a terrain must be one of {terrains}, got `{letter}`"))
            })?;
            values.push(Some(class.0))?;
        }
        let found = values.len() - before;
        if found != cols {
            return Err(wrong(number, format!("the row must have {cols} cells, got {found}")));
        }
        if values.len() > rows * cols {
            break;
        }
    }
    let mut read = ImportedRaster::new(rows, cols, 1.0, DVec2::ZERO, values)?;
    read.raster.speeds = [0.0].into_iter().chain(TERRAIN.map(|terrain| terrain.1)).collect();
    Ok(read)
}

/// Reads a MovingAI scenario file.
///
/// ```
/// use envgen::import::read_scenarios;
///
/// let text = "version 1\n0\tarena.map\t49\t49\t1\t11\t1\t12\t1\n";
/// let tasks = read_scenarios(&mut text.as_bytes())?;
/// assert_eq!((tasks[0].start, tasks[0].goal, tasks[0].length), ([1, 11], [1, 12], 1.0));
/// assert!(read_scenarios(&mut "0 arena.map\n".as_bytes()).is_err());
/// # Ok::<(), envgen::import::RasterFileError>(())
/// ```
///
/// # Errors
/// Names the line that contains the mistake.
pub fn read_scenarios(input: &mut dyn Read) -> Result<Vec<Scenario>, RasterFileError> {
    let text = file::read_text(input)?;
    let mut tasks = Vec::new();
    for (number, line) in (1..).zip(text.lines()) {
        if line.trim().is_empty() || number == 1 && line.starts_with("version") {
            continue;
        }
        let task = scenario(line).ok_or_else(|| RasterFileError::Line {
            line: number,
            what: "expected bucket, map, width, height, start x, y, goal x, y and length"
                .to_owned(),
        })?;
        tasks.push(task);
    }
    Ok(tasks)
}

fn scenario(line: &str) -> Option<Scenario> {
    let words: Vec<&str> = line.split('\t').map(str::trim).collect();
    let &[bucket, map, width, height, sx, sy, gx, gy, length] = words.as_slice() else {
        return None;
    };
    let number = |word: &str| word.parse::<u32>().ok();
    let task = Scenario {
        bucket: number(bucket)?,
        map: map.to_owned(),
        width: number(width)?,
        height: number(height)?,
        start: [number(sx)?, number(sy)?],
        goal: [number(gx)?, number(gy)?],
        length: length.parse().ok().filter(|length: &f64| length.is_finite())?,
    };
    let inside = |[x, y]: [u32; 2]| x < task.width && y < task.height;
    (inside(task.start) && inside(task.goal)).then_some(task)
}

#[cfg(test)]
mod tests {
    use super::*;

    const MAP: &str = "type octile\nheight 2\nwidth 4\nmap\n.GSW\nT@O.\n";

    #[test]
    fn a_map_is_read() {
        let read = read_map(&mut MAP.as_bytes()).unwrap();
        assert_eq!(read.raster.cells, [1, 1, 2, 3, 4, 5, 5, 1]);
        assert_eq!(read.raster.speeds, [0.0, 1.0, 0.5, 0.0, 0.0, 0.0]);
        assert_eq!(read_map(&mut MAP.replace('\n', "\r\n").as_bytes()).unwrap(), read);
    }

    #[test]
    fn what_is_wrong_is_named() {
        for (from, to, what) in [
            ("height 2", "height two", "line 2: `height` must be a whole number, got `two`"),
            ("height 2\n", "", "no line `height`"),
            ("height 2", "height 3", "values for 3 rows of 4 cells, got 8"),
            ("height 2", "height 1", "values for 1 rows of 4 cells, got 8"),
            ("width 4", "width 4000000000000", "the raster must have from 1 to"),
            ("width 4", "width 0", "the raster must have from 1 to"),
            (".GSW", ".GS", "line 5: the row must have 4 cells, got 3"),
            (".GSW", ".GSx", "line 5: a terrain must be one of .GSWT@O, got `x`"),
            ("map\n", "mop\n", "line 4: `mop` before the line `map`"),
        ] {
            let error = read_map(&mut MAP.replace(from, to).as_bytes()).unwrap_err().to_string();
            assert!(error.contains(what), "{to}: {error}");
        }
        assert!(read_map(&mut "".as_bytes()).is_err());
        for line in ["", "1\ta", "0\ta\t2\t2\t0\t0\t2\t1\t1.0", "0\ta\t2\t2\t0\t0\t1\t1\tNaN"] {
            let text = format!("version 1\n{line}\n");
            assert_eq!(read_scenarios(&mut text.as_bytes()).is_ok(), line.is_empty(), "{line}");
        }
    }
}
