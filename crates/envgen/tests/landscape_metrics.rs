//! The measures of rasters against a second, slow and obvious method for each.

use std::collections::BTreeMap;

use envgen::glam::DVec2;
use envgen::landscape::metrics::{Border, PatchReport, RasterError, RasterReport};
use envgen::world::ClassRaster;
use envgen::{Seed, Stream};

fn raster(rows: u32, cols: u32, cell: f64, cells: Vec<u16>) -> ClassRaster {
    ClassRaster { rows, cols, cell, origin: DVec2::ZERO, cells, speeds: Vec::new() }
}

/// A raster of random blocks, so that patches have several cells, with some no data.
fn random(stream: &mut Stream, rows: u32, cols: u32, classes: u64, holes: f64) -> ClassRaster {
    let mut cells = vec![1_u16; (rows * cols) as usize];
    for _ in 0..rows * cols / 2 {
        let class = 1 + stream.below(classes) as u16 * 7;
        let (r, c) = (stream.below(u64::from(rows)) as u32, stream.below(u64::from(cols)) as u32);
        let (h, w) = (stream.below(3) as u32, stream.below(3) as u32);
        for y in r..=(r + h).min(rows - 1) {
            for x in c..=(c + w).min(cols - 1) {
                cells[(y * cols + x) as usize] = class;
            }
        }
    }
    for cell in &mut cells {
        if stream.chance(holes) {
            *cell = 0;
        }
    }
    raster(rows, cols, 2.5, cells)
}

/// The class at a place, 0 outside.
fn at(raster: &ClassRaster, r: i64, c: i64) -> u16 {
    if r < 0 || c < 0 || r >= i64::from(raster.rows) || c >= i64::from(raster.cols) {
        return 0;
    }
    raster.cells[(r * i64::from(raster.cols) + c) as usize]
}

/// Sizes of patches by class, by spreading each cell's own number until nothing changes.
fn patch_sizes(raster: &ClassRaster, corners: bool) -> BTreeMap<u16, Vec<f64>> {
    let (rows, cols) = (i64::from(raster.rows), i64::from(raster.cols));
    let mut label: Vec<usize> = (0..raster.cells.len()).collect();
    loop {
        let mut changed = false;
        for r in 0..rows {
            for c in 0..cols {
                for dr in -1..=1 {
                    for dc in -1..=1 {
                        let own = at(raster, r, c);
                        if own == 0 || at(raster, r + dr, c + dc) != own {
                            continue;
                        }
                        let joined = corners || dr == 0 || dc == 0;
                        let (a, b) = ((r * cols + c) as usize, ((r + dr) * cols + c + dc) as usize);
                        if joined && label[b] < label[a] {
                            label[a] = label[b];
                            changed = true;
                        }
                    }
                }
            }
        }
        if !changed {
            break;
        }
    }
    let mut sizes: BTreeMap<(u16, usize), f64> = BTreeMap::new();
    for (&class, &label) in raster.cells.iter().zip(&label) {
        if class > 0 {
            *sizes.entry((class, label)).or_default() += 1.0;
        }
    }
    let mut by_class: BTreeMap<u16, Vec<f64>> = BTreeMap::new();
    for ((class, _), size) in sizes {
        by_class.entry(class).or_default().push(size);
    }
    by_class
}

fn near(a: Option<f64>, b: f64, what: &str) {
    match a {
        Some(a) => assert!((a - b).abs() <= 1e-9 * b.abs().max(1.0), "{what}: {a}, slowly {b}"),
        None => assert!(b.is_nan(), "{what}: none, slowly {b}"),
    }
}

fn check_patches(found: &PatchReport, sizes: &[f64], total: f64, square: f64) {
    let sum: f64 = sizes.iter().sum();
    assert_eq!(found.count, sizes.len() as u64);
    let area = total * square;
    near(found.density_per_100ha, sizes.len() as f64 * 1e6 / area, "density");
    let largest = sizes.iter().copied().fold(0.0, f64::max);
    near(found.largest_percent, 100.0 * largest * square / area, "largest");
    near(found.mean_area_m2, sum * square / sizes.len() as f64, "mean area");
    let mesh = sizes.iter().map(|s| s * square * s * square).sum::<f64>() / area;
    near(found.mesh_m2, mesh, "mesh");
}

fn least_border(cells: f64) -> f64 {
    // The least border of any rectangle that holds the cells.
    (1..=cells as u64)
        .map(|width| 2.0 * (width as f64 + (cells / width as f64).ceil()))
        .fold(f64::INFINITY, f64::min)
}

fn check(raster: &ClassRaster) {
    let report = RasterReport::new(raster, Border::Free).unwrap();
    let with_border = RasterReport::new(raster, Border::Counted).unwrap();
    let side = raster.cell;
    let mut count: BTreeMap<u16, f64> = BTreeMap::new();
    // Ordered pairs of neighbouring classes, and of classes and border.
    let mut pairs: BTreeMap<(u16, u16), f64> = BTreeMap::new();
    let mut border: BTreeMap<u16, f64> = BTreeMap::new();
    for r in 0..i64::from(raster.rows) {
        for c in 0..i64::from(raster.cols) {
            let own = at(raster, r, c);
            if own == 0 {
                continue;
            }
            *count.entry(own).or_default() += 1.0;
            for (dr, dc) in [(0, 1), (1, 0), (0, -1), (-1, 0)] {
                match at(raster, r + dr, c + dc) {
                    0 => *border.entry(own).or_default() += 1.0,
                    other => *pairs.entry((own, other)).or_default() += 1.0,
                }
            }
        }
    }
    let total: f64 = count.values().sum();
    let m = count.len() as f64;
    let unlike = |class: u16| -> f64 {
        pairs.iter().filter(|(p, _)| p.0 == class && p.1 != class).map(|p| p.1).sum()
    };
    let edges: f64 = count.keys().map(|&class| unlike(class)).sum::<f64>() / 2.0;
    let outer: f64 = border.values().sum();
    assert_eq!(report.edge_count as f64, edges);
    assert_eq!(with_border.edge_count as f64, edges + outer);
    near(report.ted, edges / total, "TED");
    assert_eq!(report.total_edge_m, edges * side);
    let hectares = total * side * side / 10_000.0;
    near(report.edge_density_m_per_ha, edges * side / hectares, "ED");
    near(with_border.edge_density_m_per_ha, (edges + outer) * side / hectares, "ED with border");

    let entropy = |p: &mut dyn Iterator<Item = f64>| -> f64 {
        p.map(|p| if p > 0.0 { -p * libm::log(p) } else { 0.0 }).sum()
    };
    let shdi = entropy(&mut count.values().map(|n| n / total));
    near(report.shdi, if total > 0.0 { shdi } else { f64::NAN }, "SHDI");
    near(report.shei, if m > 1.0 { shdi / libm::log(m) } else { f64::NAN }, "SHEI");
    let simpson = 1.0 - count.values().map(|n| n / total * (n / total)).sum::<f64>();
    near(report.sidi, if total > 0.0 { simpson } else { f64::NAN }, "SIDI");

    let mut contagion = 1.0;
    for (&(a, b), n) in &pairs {
        let of_a: f64 = pairs.range((a, 0)..=(a, u16::MAX)).map(|(_, n)| *n).sum();
        let p = count[&a] / total * n / of_a;
        contagion += p * libm::log(p) / (2.0 * libm::log(m));
        assert_eq!(pairs[&(b, a)], *n);
    }
    let defined = m > 1.0 && !pairs.is_empty();
    near(report.contag_percent, if defined { 100.0 * contagion } else { f64::NAN }, "CONTAG");
    let mixing = entropy(&mut pairs.iter().filter(|(p, _)| p.0 < p.1).map(|p| p.1 / edges));
    let most = libm::log(m * (m - 1.0) / 2.0);
    let defined = m > 2.0 && edges > 0.0;
    near(report.iji_percent, if defined { 100.0 * mixing / most } else { f64::NAN }, "IJI");
    let lsi = if total > 0.0 { (edges + outer) / least_border(total) } else { f64::NAN };
    near(report.lsi, lsi, "LSI");

    let sides: f64 = pairs.values().sum();
    let bits = libm::log(2.0);
    let joint = entropy(&mut pairs.values().map(|n| n / sides)) / bits;
    let marginal = entropy(
        &mut count
            .keys()
            .map(|&class| pairs.iter().filter(|(p, _)| p.0 == class).map(|p| p.1 / sides).sum()),
    ) / bits;
    let or_none = |value: f64| if sides > 0.0 { value } else { f64::NAN };
    near(report.joint_entropy_bits, or_none(joint), "H(x, y)");
    near(report.conditional_entropy_bits, or_none(joint - marginal), "H(y | x)");
    near(report.mutual_information_bits, or_none(2.0 * marginal - joint), "mutual information");

    let (eight, four) = (patch_sizes(raster, true), patch_sizes(raster, false));
    if total > 0.0 {
        let all =
            |sizes: &BTreeMap<u16, Vec<f64>>| sizes.values().flatten().copied().collect::<Vec<_>>();
        check_patches(&report.patches_8, &all(&eight), total, side * side);
        check_patches(&report.patches_4, &all(&four), total, side * side);
    }
    assert_eq!(report.by_class.len(), count.len());
    let mut lengths = 0.0;
    for (class, (&number, &cells)) in report.by_class.iter().zip(&count) {
        assert_eq!(class.class, i64::from(number));
        near(Some(class.area_m2), cells * side * side, "area");
        near(Some(class.share_percent), 100.0 * cells / total, "share");
        near(Some(class.total_edge_m), unlike(number) * side, "class edge");
        let around = unlike(number) + border.get(&number).copied().unwrap_or(0.0);
        near(Some(class.lsi), around / least_border(cells), "class LSI");
        check_patches(&class.patches_8, &eight[&number], total, side * side);
        check_patches(&class.patches_4, &four[&number], total, side * side);
        lengths += class.total_edge_m;
    }
    near(Some(lengths), 2.0 * report.total_edge_m, "all classes' edges");
}

#[test]
fn many_rasters_agree_with_the_slow_method() {
    let mut stream = Seed(1).stream("rasters", 0);
    for (rows, cols, classes, holes) in [
        (12, 17, 3, 0.0),
        (25, 14, 9, 0.1),
        (20, 20, 40, 0.3),
        (9, 30, 2, 0.02),
        (1, 40, 4, 0.1),
        (40, 1, 4, 0.0),
        (1, 1, 1, 0.0),
        (2, 2, 5, 0.5),
        (16, 16, 1, 0.0),
        (16, 16, 1, 0.2),
        (6, 6, 3, 1.0),
        (22, 22, 5, 0.9),
    ] {
        check(&random(&mut stream, rows, cols, classes, holes));
    }
    // Over 512 classes, which are counted by another method.
    let cells = (0..900).map(|_| 1 + stream.below(700) as u16 * 90).collect();
    check(&raster(30, 30, 0.1, cells));
}

#[test]
fn a_raster_that_can_be_checked_by_hand() {
    // 2 2 2 2
    // 2 1 1 2    three classes on 4 x 4 cells of 10 m
    // 2 1 3 2
    // 2 2 2 2
    let cells = vec![2, 2, 2, 2, 2, 1, 1, 2, 2, 1, 3, 2, 2, 2, 2, 2];
    let report = RasterReport::new(&raster(4, 4, 10.0, cells), Border::Free).unwrap();
    // Class 1 and 3 form a block of 8 sides against class 2, and share 2.
    assert_eq!(report.edge_count, 10);
    assert_eq!(report.total_edge_m, 100.0);
    assert_eq!(report.edge_density_m_per_ha, Some(625.0));
    assert_eq!(report.sidi, Some(1.0 - (9.0 + 144.0 + 1.0) / 256.0));
    assert_eq!(report.lsi, Some((10.0 + 16.0) / 16.0));
    assert_eq!((report.patches_8.count, report.patches_4.count), (3, 3));
    assert_eq!(report.patches_8.largest_percent, Some(75.0));
    assert_eq!(report.patches_8.mesh_m2, Some((144.0 + 9.0 + 1.0) / 16.0 * 100.0));
    let one = &report.by_class[0];
    assert_eq!((one.class, one.area_m2, one.total_edge_m), (1, 300.0, 80.0));
    // Three cells have a border of 8 at least, and this class has just that.
    assert_eq!(one.lsi, 1.0);
    let named = report.labelled(&[11, -4, 70_000]);
    assert_eq!(named.by_class.iter().map(|c| c.class).collect::<Vec<_>>(), [11, -4, 70_000]);
}

#[test]
fn the_keys_are_those_agreed() {
    let report = RasterReport::new(&raster(1, 2, 1.0, vec![1, 2]), Border::Free).unwrap();
    let json = serde_json::to_value(&report).unwrap();
    let keys = |value: &serde_json::Value| -> Vec<String> {
        value.as_object().unwrap().keys().cloned().collect()
    };
    let mut expected = vec![
        "edge_count",
        "ted",
        "total_edge_m",
        "edge_density_m_per_ha",
        "shdi",
        "shei",
        "sidi",
        "contag_percent",
        "iji_percent",
        "lsi",
        "joint_entropy_bits",
        "conditional_entropy_bits",
        "mutual_information_bits",
        "patches_8",
        "patches_4",
        "by_class",
    ];
    expected.sort_unstable();
    let mut found = keys(&json);
    found.sort();
    assert_eq!(found, expected);
    let mut patches = keys(&json["patches_8"]);
    patches.sort();
    assert_eq!(
        patches,
        ["count", "density_per_100ha", "largest_percent", "mean_area_m2", "mesh_m2"]
    );
    let mut class = keys(&json["by_class"][0]);
    class.sort();
    assert_eq!(
        class,
        ["area_m2", "class", "lsi", "patches_4", "patches_8", "share_percent", "total_edge_m"]
    );
    assert!(json["iji_percent"].is_null());
}

#[test]
fn measures_of_zero_are_not_negative() {
    // One class; and three classes of which only two are neighbours.
    for (cols, cells) in [(3, vec![1; 6]), (3, vec![1, 2, 0, 0, 0, 3])] {
        let report = RasterReport::new(&raster(2, cols, 1.0, cells), Border::Free).unwrap();
        let json = serde_json::to_string(&report).unwrap();
        assert!(!json.contains("-0"), "{json}");
        assert!(!report.to_string().contains("-0"), "{report}");
    }
}

#[test]
fn classes_without_neighbours_have_no_contagion() {
    let report = RasterReport::new(&raster(2, 2, 1.0, vec![1, 0, 0, 2]), Border::Free).unwrap();
    assert_eq!((report.contag_percent, report.joint_entropy_bits), (None, None));
    assert_eq!(report.shei, Some(1.0));
}

#[test]
fn rasters_that_do_not_fit_are_errors() {
    let wrong = raster(2, 2, 1.0, vec![1, 2, 3]);
    let error = RasterReport::new(&wrong, Border::Free);
    assert_eq!(error, Err(RasterError::Size { rows: 2, cols: 2, cells: 3 }));
    for cell in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        let error = RasterReport::new(&raster(1, 1, cell, vec![1]), Border::Free);
        assert!(matches!(error, Err(RasterError::Cell(_))));
    }
    let none = RasterReport::new(&raster(0, 0, 1.0, vec![]), Border::Free).unwrap();
    assert_eq!((none.ted, none.lsi, none.patches_8.count), (None, None, 0));
}
