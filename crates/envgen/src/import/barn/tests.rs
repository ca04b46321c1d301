use proptest::prelude::*;

use super::npy::tests::file;
use super::*;
use crate::import::{read_world, reader};

/// A field of 12 rows and 9 columns with a block of its own, made for these tests.
const FIELD: [&str; 12] = [
    "#########",
    "#........",
    ".........",
    ".........",
    ".........",
    ".........",
    ".........",
    ".........",
    ".........",
    "......###",
    "......###",
    "#########",
];

const PATH: [[u32; 2]; 9] =
    [[5, 0], [5, 1], [4, 2], [4, 3], [3, 4], [4, 5], [4, 6], [4, 7], [4, 8]];

fn grid() -> BarnGrid {
    let filled = FIELD.iter().flat_map(|row| row.bytes().map(|cell| cell == b'#')).collect();
    BarnGrid::new(9, filled).unwrap()
}

fn model(number: usize, x: f64, y: f64) -> String {
    let cylinder =
        "<geometry><cylinder><radius>0.075000</radius><length>1</length></cylinder></geometry>";
    format!(
        "<model name='unit_cylinder_{number}'><static>1</static>\
         <pose frame=''>{x:.6} {y:.6} 0.000000 0.000000 0.000000 0.000000</pose>\
         <link name='link'><collision name='collision'>{cylinder}</collision>\
         <visual name='visual'>{cylinder}</visual></link></model>\n"
    )
}

/// A Gazebo world of a grid as BARN's code writes it: walls around the first position, and the filled cells
/// that have a free neighbour or are at the border.
fn gazebo_world(grid: &BarnGrid) -> String {
    let (rows, cols) = (grid.rows(), grid.cols());
    let x = |row: usize| -(rows as f64) * 0.15 + 0.075 + row as f64 * 0.15;
    let y = |col: usize| 0.075 + col as f64 * 0.15;
    let mut models = Vec::new();
    models.extend((0..rows).map(|row| (x(row), y(0))));
    for col in 1..34 {
        models.extend([(x(0), y(col)), (x(rows - 1), y(col))]);
    }
    let filled = |row: usize, col: usize| grid.filled()[row * cols + col];
    for (row, col) in (0..rows).flat_map(|row| (0..cols).map(move |col| (row, col))) {
        let is_inner = row > 0 && row + 1 < rows && col > 0 && col + 1 < cols;
        let hidden = is_inner
            && (row - 1..=row + 1).all(|row| (col - 1..=col + 1).all(|col| filled(row, col)));
        if filled(row, col) && !hidden {
            models.push((x(row), y(34 + col)));
        }
    }
    let plane = "<model name='ground_plane'><static>1</static><link name='link'><collision name='collision'>\
                 <geometry><plane><normal>0 0 1</normal></plane></geometry></collision></link></model>";
    let models: String = models.iter().enumerate().map(|(i, &(x, y))| model(i, x, y)).collect();
    let state = "<state world_name='default'><model name='unit_cylinder_0'><pose>9 9 0 0 0 0</pose></model>\
                 </state>";
    format!(
        "<sdf version='1.6'><world name='default'><light name='sun'/>{plane}{models}{state}</world></sdf>\n"
    )
}

fn array(rows: usize, cols: usize, values: impl IntoIterator<Item = i64>) -> Vec<u8> {
    let header = format!(
        "{{'descr': '<i8', 'fortran_order': False, 'shape': ({rows}, {cols}), }}          \n"
    );
    let data: Vec<u8> = values.into_iter().flat_map(i64::to_le_bytes).collect();
    file(&header, &data)
}

fn grid_file() -> Vec<u8> {
    let grid = grid();
    array(12, 9, grid.filled().iter().map(|&filled| i64::from(filled)))
}

const COMPASS: [(i64, i64); 8] =
    [(-1, -1), (-1, 0), (-1, 1), (0, -1), (0, 1), (1, -1), (1, 0), (1, 1)];

/// BARN's five metrics from their definition, step by step, as its code counts them.
fn plain_metrics(grid: &BarnGrid, path: &[[u32; 2]]) -> [f64; 5] {
    let (rows, cols) = (grid.rows() as i64, grid.cols() as i64);
    let is_inside = |r: i64, c: i64| r >= 0 && c >= 0 && r < rows && c < cols;
    let is_filled = |r: i64, c: i64| is_inside(r, c) && grid.filled()[(r * cols + c) as usize];
    let blocked =
        |r: i64, c: i64| (r - 2..=r + 2).any(|i| (c - 2..=c + 2).any(|j| is_filled(i, j)));
    let length = |(dr, dc): (i64, i64)| ((dr * dr + dc * dc) as f64).sqrt();
    // The order in which the published code lists its rays.
    let rays = [
        (0, 1),
        (1, 2),
        (1, 1),
        (2, 1),
        (1, 0),
        (2, -1),
        (1, -1),
        (1, -2),
        (0, -1),
        (-2, -1),
        (-1, -1),
        (-1, -2),
        (-1, 0),
        (-2, 1),
        (-1, 1),
        (-1, 2),
    ];
    let mut sums = [0.0; 4];
    for cell in path {
        let (r, c) = (i64::from(cell[0]), i64::from(cell[1]));
        let cells = (0..rows).flat_map(|i| (0..cols).map(move |j| (i, j)));
        let away = cells.filter(|&(i, j)| blocked(i, j)).map(|(i, j)| length((i - r, j - c)));
        sums[0] += away.fold(f64::INFINITY, f64::min);
        let free = |(dr, dc): (i64, i64), from: i64| {
            (from..)
                .take_while(|k| {
                    is_inside(r + k * dr, c + k * dc) && !blocked(r + k * dr, c + k * dc)
                })
                .count() as f64
        };
        sums[1] += COMPASS.iter().map(|&ray| free(ray, 0) * length(ray)).sum::<f64>() / 8.0;
        let meets = rays.map(|(dr, dc)| {
            let (mut i, mut j, mut count) = (r, c, 0);
            while count < 3 {
                (i, j) = (i + dr, j + dc);
                if !is_inside(i, j) {
                    return false;
                }
                if blocked(i, j) {
                    return true;
                }
                count += if dr == 2 || dc == 2 { 2 } else { 1 };
            }
            false
        });
        sums[2] += (0..16).filter(|&i| meets[i] != meets[(i + 1) % 16]).count() as f64;
        let axis = |(dr, dc)| (free((dr, dc), 1) + free((-dr, -dc), 1)) * length((dr, dc));
        sums[3] +=
            [(0, 1), (1, 0), (1, 1), (1, -1)].map(axis).into_iter().fold(f64::INFINITY, f64::min);
    }
    let step = |a: [u32; 2], b: [u32; 2]| {
        length((i64::from(b[0]) - i64::from(a[0]), i64::from(b[1]) - i64::from(a[1])))
    };
    let along: f64 = path.windows(2).map(|pair| step(pair[0], pair[1])).sum();
    let [closest, visibility, dispersion, dimension] = sums.map(|sum| sum / path.len() as f64);
    [closest, visibility, dispersion, dimension, along / step(path[0], path[path.len() - 1])]
}

/// The five metrics in the order of the published code.
fn metrics(grid: &BarnGrid, path: &[[u32; 2]]) -> [f64; 5] {
    let found = grid.metrics(path, BarnMode::Reference).unwrap();
    [
        found.closest_obstacle_cells.unwrap(),
        found.visibility_cells,
        found.dispersion,
        found.characteristic_dimension_cells,
        found.tortuosity.unwrap(),
    ]
}

#[test]
fn metrics_are_those_that_the_published_code_prints() {
    // `DifficultyMetrics(c_space, path, 3).avg_all_metrics()` of BARN's difficulty_quant.py.
    let published = [
        1.7126903958192328,
        3.631261020678228,
        4.444444444444445,
        2.7015231665538626,
        1.1464084845302598,
    ];
    for found in [metrics(&grid(), &PATH), plain_metrics(&grid(), &PATH)] {
        for (found, published) in found.into_iter().zip(published) {
            assert!((found - published).abs() < 1e-12, "{found} {published}");
        }
    }
}

proptest! {
    #[test]
    fn metrics_are_those_of_the_published_definition(
        cols in 6_usize..31,
        filled in proptest::collection::vec(0..100_u32, 36..900),
        share in 1..8_u32,
        steps in proptest::collection::vec(0..8_usize, 1..40),
    ) {
        let whole = filled.len() / cols * cols;
        let grid = BarnGrid::new(cols, filled[..whole].iter().map(|&at| at < share).collect());
        let Ok(grid) = grid else { return Ok(()) };
        let blocked = grid.c_space();
        let Some(first) = blocked.iter().position(|blocked| !blocked) else { return Ok(()) };
        if !blocked.contains(&true) {
            return Ok(());
        }
        // A walk over free cells.
        let mut path = vec![[(first / cols) as u32, (first % cols) as u32]];
        for step in steps {
            let (dr, dc) = COMPASS[step];
            let [r, c] = path[path.len() - 1].map(i64::from);
            let (r, c) = (r + dr, c + dc);
            let is_inside = r >= 0 && c >= 0 && r < grid.rows() as i64 && c < cols as i64;
            if is_inside && !blocked[(r * cols as i64 + c) as usize] {
                path.push([r as u32, c as u32]);
            }
        }
        if path[0] != path[path.len() - 1] {
            for (found, plain) in metrics(&grid, &path).into_iter().zip(plain_metrics(&grid, &path)) {
                prop_assert!((found - plain).abs() < 1e-12, "{} {}", found, plain);
            }
        }
    }
}

#[test]
fn the_grid_of_a_gazebo_world_has_the_same_c_space() {
    let text = gazebo_world(&grid());
    let cylinders = read_cylinders(&text).unwrap();
    // One cylinder of the block at the right is hidden by those around it.
    let filled = grid().filled().iter().filter(|filled| **filled).count();
    assert_eq!(cylinders.len(), 12 + 66 + filled - 1);
    let found = BarnGrid::of_cylinders(&cylinders).unwrap();
    assert_eq!((found.rows(), found.cols()), (12, 9));
    assert_eq!(found, grid());
    assert_eq!(found.c_space(), grid().c_space());
}

#[test]
fn grids_become_worlds_in_the_frame_of_the_gazebo_world() {
    let folder = tempfile::tempdir().unwrap();
    let paths = folder.path().join("path_files");
    let grids = folder.path().join("grid_files");
    std::fs::create_dir(&paths).unwrap();
    std::fs::create_dir(&grids).unwrap();
    let file = grids.join("grid_7.npy");
    std::fs::write(&file, grid_file()).unwrap();
    let alone = read_world(&file).unwrap();
    let numbers = PATH.iter().flatten().map(|&number| i64::from(number));
    std::fs::write(paths.join("path_7.npy"), array(9, 2, numbers)).unwrap();
    let world = read_world(&file).unwrap();
    let place = |row: f64, col: f64| DVec2::new(-1.8 + 0.15 * row, 0.15 * (34.0 + col)) + 0.075;
    let near = |pose: Option<Pose>, row: f64, col: f64| {
        pose.is_some_and(|pose| pose.position.distance(place(row, col)) < 1e-9)
    };
    assert!(near(world.start, 5.0, 0.0) && near(world.goal, 4.0, 8.0));
    // Without the path: of rows 5 and 6, as near to the middle, the upper one; in the last column row 5.
    assert!(near(alone.start, 5.0, 0.0) && near(alone.goal, 5.0, 8.0), "{:?}", alone.goal);
    for (i, &filled) in grid().filled().iter().enumerate() {
        let p = place((i / 9) as f64, (i % 9) as f64);
        assert_eq!(world.clearance(p) == 0.0, filled, "{i}");
    }
    // Every cylinder of the Gazebo world lies in a block.
    let text = gazebo_world(&grid());
    let blocks = |cylinder: &&Cylinder| cylinder.center.y > 0.15 * 34.0;
    for cylinder in read_cylinders(&text).unwrap().iter().filter(blocks) {
        assert_eq!(world.clearance(cylinder.center), 0.0);
    }
    std::fs::write(paths.join("path_7.npy"), array(1, 2, [40, 0])).unwrap();
    let error = read_world(&file).unwrap_err().to_string();
    assert!(
        error.starts_with("`path` must be of cells in 12 rows and 9 columns, got [40, 0]"),
        "{error}"
    );
    std::fs::write(paths.join("path_7.npy"), "x").unwrap();
    assert!(read_world(&file).unwrap_err().to_string().contains("path_7.npy: not a NumPy file"));
}

#[test]
fn gazebo_worlds_keep_their_cylinders_and_have_the_start_of_the_challenge() {
    // As many rows as in the data set, so that the walls are beside the start.
    let filled = (0..270).map(|cell| !(9..261).contains(&cell)).collect();
    let text = gazebo_world(&BarnGrid::new(9, filled).unwrap());
    let path = Path::new("world_3.world");
    let world = reader(path).unwrap()(&mut text.as_bytes(), path).unwrap();
    assert_eq!(world.obstacles.len(), 30 + 66 + 18);
    let start = world.start.unwrap();
    assert_eq!((start.position, start.heading), (DVec2::new(-2.25, 3.0), HEADING));
    assert_eq!(world.goal.unwrap().position, DVec2::new(-2.25, 13.0));
    assert_eq!(world.clearance(DVec2::new(-4.425, 5.175)), 0.0);
}

#[test]
fn maps_for_ros_of_the_data_set_are_read() {
    let folder = tempfile::tempdir().unwrap();
    let yaml = "image: map_pgm_7.pgm\nresolution: 0.150000\norigin: [-4.500000, 0.000000, 0.000000]\n\
                occupied_thresh: 0.5\nfree_thresh: 0.5\nnegate: 0\n\n\n";
    let mut image = b"P5\n3  2  255\n".to_vec();
    image.extend([0, 255, 0, 0, 0, 0]);
    std::fs::write(folder.path().join("map_pgm_7.pgm"), image).unwrap();
    let file = folder.path().join("yaml_7.yaml");
    std::fs::write(&file, yaml).unwrap();
    let world = read_world(&file).unwrap();
    assert!(world.start.unwrap().position.distance(DVec2::new(-4.275, 0.225)) < 1e-12);
    assert_eq!(world.clearance(DVec2::new(-4.4, 0.2)), 0.0);
}

#[test]
fn what_is_wrong_is_named() {
    let text = gazebo_world(&grid());
    for (from, to, what) in [
        ("</world></sdf>", "", "it ends inside an element"),
        ("<world", "<room", "not a Gazebo world of cylinders: ill-formed document"),
        ("0.075000</radius>", "0</radius>", "`radius` must be from 0.001 to 1000 m, got `0`"),
        ("0.075000</radius>", "wide</radius>", "`radius` must be"),
        (
            "-1.725000 0.075000 0.000000",
            "-1.725000 NaN 0.000000",
            "`pose` must be six finite numbers",
        ),
        ("-1.725000 0.075000 0.000000", "-1e9 0 0", "`pose` must be up to 1e8 m from the axes"),
        ("0.000000 0.000000 0.000000 0.000000</pose>", "0 1.57 0 0</pose>", "and upright"),
        ("<plane>", "<heightmap/><plane>", "`geometry` must be one for each model, got plane"),
        ("<geometry><plane>", "<geometry><mesh/></geometry><geometry><plane>", "got plane"),
        ("<sdf", "<!DOCTYPE sdf><sdf", "it has a document type"),
    ] {
        let error = read_cylinders(&text.replacen(from, to, 1)).unwrap_err().to_string();
        assert!(error.contains(what), "{to}: {error}");
    }
    // Without a pose, a model is at the origin.
    let cylinder = "<sdf><world><model><link><collision><geometry><cylinder><radius>0.075</radius></cylinder>\
                    </geometry></collision></link></model></world></sdf>";
    let at_origin = read_cylinders(cylinder).expect("a world");
    assert!(at_origin.iter().any(|cylinder| cylinder.center == DVec2::ZERO), "{at_origin:?}");
    let mesh = text.replacen("<cylinder>", "<mesh>", 1).replacen("</cylinder>", "</mesh>", 1);
    let error = read_cylinders(&mesh).unwrap_err().to_string();
    assert!(error.contains("`geometry` must be `cylinder` or `plane`, got mesh"), "{error}");
    assert!(read_cylinders("").unwrap_err().to_string().contains("no `world`"));
    let deep = format!("<sdf><world>{}", "<a>".repeat(1000));
    assert!(read_cylinders(&deep).unwrap_err().to_string().contains("at most 32 elements"));
    let off = [Cylinder { center: DVec2::new(-0.075, 5.2), radius: 0.075 }];
    let error = BarnGrid::of_cylinders(&off).unwrap_err().to_string();
    assert!(error.contains("`cylinder` must be the middle of a cell of 0.15 m"), "{error}");
    assert!(BarnGrid::of_cylinders(&[]).is_err());
    let three = array(1, 3, [0, 1, 2]);
    let error = BarnGrid::read(&mut three.as_slice()).unwrap_err().to_string();
    assert!(error.contains("`cell (0, 2)` must be 0 or 1, got 2"), "{error}");
    let error = read_path(&mut three.as_slice()).unwrap_err().to_string();
    assert!(error.contains("`shape` must be two columns for a path, got 3"), "{error}");
    let error = read_path(&mut array(1, 2, [-1, 0]).as_slice()).unwrap_err().to_string();
    assert!(error.contains("`path` must be rows and columns from 0 on, got -1"), "{error}");
}

#[test]
fn poses_of_links_and_collisions_add_up() {
    let world = |link: &str, collision: &str| {
        format!(
            "<sdf version='1.6'><world name='default'><model name='a'><pose>1 2 0.5 0 0 0.5</pose><link name='l'>{link}\
             <collision name='c'>{collision}<geometry><cylinder><radius>0.2</radius></cylinder></geometry></collision>\
             </link></model></world></sdf>"
        )
    };
    let center = |text: &str| read_cylinders(text).map(|found| found[0].center);
    assert_eq!(center(&world("", "")).unwrap(), DVec2::new(1.0, 2.0));
    let turned = world("<pose>3 0 0 0 0 0</pose>", "<pose>0 4 0 0 0 0</pose>");
    let expected =
        DVec2::new(1.0, 2.0) + crate::geometry::unit_vector(0.5).rotate(DVec2::new(3.0, 4.0));
    assert!(center(&turned).unwrap().distance(expected) < 1e-12);
    assert!(center(&world("<pose>3 0 0 0.1 0 0</pose>", "")).is_err());
    // As Gazebo saves worlds after it moved the models.
    let settled = world("<pose>3 4 0 1e-10 -2e-6 0</pose>", "");
    assert_eq!(center(&settled).unwrap(), center(&turned).unwrap());
    assert!(center(&world("<pose>3 0 0 0 -0.0011 0</pose>", "")).is_err());
    // Other links and collisions do not count; a pose may come after what it places.
    let others = "<sdf version='1.6'><world name='default'><model name='a'><pose>1 2 0 0 0 0</pose>\
                  <link name='v'><pose>7 7 0 0 0 0</pose></link><link name='l'><collision name='c'><geometry><cylinder>\
                  <radius>0.2</radius></cylinder></geometry><pose>0 4 0 0 0 0</pose></collision><collision name='d'>\
                  <pose>9 9 0 0 0 0</pose></collision><pose>3 0 0 0 0 0</pose></link><link name='w'><pose>8 8 0 0 0 0</pose>\
                  </link></model></world></sdf>";
    assert_eq!(center(others).unwrap(), DVec2::new(4.0, 6.0));
}
