//! Reproduces the four figures of Kuznetsov (2017), Generation of a random landscape by given
//! configuration entropy and Total Edge, with our numbers beside the printed ones. A fifth figure
//! shows the aim of the paper: one entropy and one Total Edge in every look.
//!
//! `cargo run --release --example landscape_figures -- --out docs/figures`

use std::error::Error;
use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::{env, fs};

use envgen::landscape::published::{TABLE_1, published_ted, random_ted};
use envgen::landscape::{
    Algorithm, Composition, Landscape, LandscapeSpec, automaton_fill, edge_count, edge_upper_bound,
    largest_entropy, mean_edge_count, random_fill,
};
use envgen::palette::{self, Srgb};
use envgen::{Seed, Spec};
use plotters::prelude::*;

type Result<T = ()> = std::result::Result<T, Box<dyn Error>>;

/// The paper's grid and number of repetitions.
const SIDE: usize = 48;
const CELLS: u64 = (SIDE * SIDE) as u64;
const REPEATS: u64 = 50;

/// Colours of curves.
const COLOURS: [Srgb; 6] = [
    palette::BLUE,
    palette::VERMILION,
    palette::GREEN,
    palette::PURPLE,
    palette::SKY_BLUE,
    Srgb([0; 3]),
];

fn main() -> Result {
    let out = folder()?;
    fs::create_dir_all(&out)?;
    let mut report = String::from(
        "# Kuznetsov's figures, printed and reproduced\n\n\
         Made by `cargo run --release --example landscape_figures -- --out docs/figures`. TED is \
         Total Edge by number of cells; all maps have 48 x 48 cells.\n",
    );
    figure_1(&out, &mut report)?;
    figure_2(&out, &mut report)?;
    figure_3(&out, &mut report)?;
    figure_4(&out, &mut report)?;
    looks(&out, &mut report)?;
    fs::write(out.join("landscape.md"), report)?;
    Ok(())
}

fn folder() -> Result<PathBuf> {
    let arguments: Vec<String> = env::args().skip(1).collect();
    match arguments.as_slice() {
        [] => Ok(PathBuf::from("docs/figures")),
        [flag, folder] if flag == "--out" => Ok(PathBuf::from(folder)),
        _ => Err("usage: landscape_figures [--out FOLDER]".into()),
    }
}

fn ted(cells: &[u16]) -> f64 {
    edge_count(cells, SIDE) as f64 / CELLS as f64
}

fn mean(many: u64, value: impl Fn(u64) -> f64) -> f64 {
    (0..many).map(value).sum::<f64>() / many as f64
}

/// Mean TED of the automaton over the paper's number of maps.
fn automaton_ted(counts: &[u32], epsilon: f64) -> f64 {
    mean(REPEATS, |seed| {
        let mut stream = Seed(seed).stream("landscape/automaton", 0);
        ted(&automaton_fill(SIDE, SIDE, counts, epsilon, &mut stream))
    })
}

fn figure_1(out: &Path, report: &mut String) -> Result {
    report.push_str(
        "\n## Figure 1: random filling, 10 classes\n\n\
         | S | TED printed | TED exact mean | TED here | largest TED possible |\n\
         |---|---|---|---|---|\n",
    );
    let mut maps = Vec::new();
    for (entropy, printed) in [(0.349_119, 0.408_42), (1.1004, 1.057_73), (2.000_13, 1.634_11)] {
        let spec = LandscapeSpec { classes: 10, entropy, ..Default::default() };
        let map = spec.generate(Seed(1))?;
        let (rows, cols) = (SIDE as u64, SIDE as u64);
        let exact = mean_edge_count(rows, cols, map.counts()) / CELLS as f64;
        let most = edge_upper_bound(rows, cols, map.counts()) as f64 / CELLS as f64;
        writeln!(
            report,
            "| {entropy} | {printed:.4} | {exact:.4} | {:.4} | {most:.4} |",
            map.ted()
        )?;
        maps.push((format!("S = {entropy}, TED = {:.4} (printed {printed:.4})", map.ted()), map));
    }
    report.push_str(
        "\nThe first printed value is impossible: counts of that entropy allow a Total Edge of \
         about 880, printed is 941. The second lies below the mean of random fillings.\n\n\
         ![Figure 1](landscape_1.svg)\n",
    );
    draw_maps(&out.join("landscape_1.svg"), &maps)
}

fn figure_2(out: &Path, report: &mut String) -> Result {
    report.push_str(
        "\n## Figure 2: the automaton's TED by epsilon, 152 classes\n\n\
         Means of 50 maps; in brackets the paper's formula with its table 1. Smax is the largest entropy, \
         the logarithm of the number of classes.\n\n\
         | epsilon | S/Smax 0.2 | 0.4 | 0.6 | 0.8 | 1.0 |\n|---|---|---|---|---|---|\n",
    );
    let epsilons = [0.02, 0.05, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 1.0];
    let mut curves = Vec::new();
    for fit in TABLE_1 {
        let most = largest_entropy(CELLS, 152);
        let entropy = (fit.relative_entropy * libm::log(152.0)).min(most);
        let composition = Composition::closest(CELLS, 152, entropy, false)?;
        let found = epsilons.map(|epsilon| automaton_ted(composition.counts(), epsilon));
        let model = epsilons.map(|epsilon| published_ted(&fit, epsilon).unwrap_or(f64::NAN));
        curves.push((fit.relative_entropy, found, model));
    }
    for (i, epsilon) in epsilons.iter().enumerate() {
        write!(report, "| {epsilon} |")?;
        for (_, found, model) in &curves {
            write!(report, " {:.3} ({:.3}) |", found[i], model[i])?;
        }
        report.push('\n');
    }
    report.push_str("\n![Figure 2](landscape_2.svg)\n");
    let series: Vec<Series> = curves
        .iter()
        .map(|(part, found, model)| Series {
            name: format!("S/Smax = {part}"),
            points: epsilons.into_iter().zip(found.iter().copied()).collect(),
            line: epsilons.into_iter().zip(model.iter().copied()).collect(),
        })
        .collect();
    let what = "dots: 50 maps each, lines: the paper's formula";
    draw_curves(&out.join("landscape_2.svg"), ("epsilon", what), (1.0, 2.2), &series)
}

fn figure_3(out: &Path, report: &mut String) -> Result {
    report.push_str(
        "\n## Figure 3: maps of the automaton, 9 classes\n\n\
         | S | epsilon | TED printed | TED, mean of 50 | exact map: TE asked | TE reached |\n\
         |---|---|---|---|---|---|\n",
    );
    let mut maps = Vec::new();
    for (entropy, epsilon, printed) in
        [(1.900_26, 0.05, 0.728_733), (2.197_22, 0.2, 1.031_25), (1.900_26, 0.9, 1.575_52)]
    {
        let composition = Composition::closest(CELLS, 9, entropy, false)?;
        let found = automaton_ted(composition.counts(), epsilon);
        // The paper's aim: exactly its Total Edge.
        let target = (printed * CELLS as f64).round() as u64;
        let spec = LandscapeSpec {
            classes: 9,
            entropy,
            algorithm: Algorithm::Automaton,
            total_edge: Some(target),
            ..Default::default()
        };
        let map = spec.generate(Seed(1))?;
        writeln!(
            report,
            "| {entropy} | {epsilon} | {printed:.4} | {found:.4} | {target} | {} |",
            map.total_edge()
        )?;
        let here = map.epsilon().unwrap_or(0.0);
        maps.push((format!("S = {entropy}, TE = {target}, epsilon {here:.3}"), map));
    }
    report.push_str(
        "\nThe first and the third printed value lie above what their epsilons give on average: \
         single maps spread by 0.04 and by 0.02.\n\n\
         ![Figure 3](landscape_3.svg)\n",
    );
    draw_maps(&out.join("landscape_3.svg"), &maps)
}

fn figure_4(out: &Path, report: &mut String) -> Result {
    report.push_str(
        "\n## Figure 4: TED of random filling by entropy\n\n\
         Exact means for l classes; in brackets means of 50 maps, then the paper's fit a1 s(b1 S / ln l) - a1 / 2, \
         where it has a value: it is singular at 10.96 classes and good from 20 on.\n\n\
         | S/Smax | l = 3 | 6 | 12 | 25 | 50 | 150 |\n|---|---|---|---|---|---|---|\n",
    );
    let classes = [3_u32, 6, 12, 25, 50, 150];
    let parts: Vec<f64> = (0..=20).map(|i| f64::from(i) / 20.0).collect();
    let mut series = Vec::new();
    let mut columns = Vec::new();
    for l in classes {
        let (mut exact, mut simulated, mut fitted) = (Vec::new(), Vec::new(), Vec::new());
        for &part in &parts {
            let most = largest_entropy(CELLS, u64::from(l));
            let entropy = (part * libm::log(f64::from(l))).min(most);
            let composition = Composition::closest(CELLS, u64::from(l), entropy, false)?;
            let counts = composition.counts();
            let side = SIDE as u64;
            exact.push(mean_edge_count(side, side, counts) / CELLS as f64);
            simulated.push(mean(REPEATS, |seed| ted(&random_fill(counts, Seed(seed)))));
            fitted.push(random_ted(l, entropy));
        }
        series.push(Series {
            name: format!("l = {l}"),
            points: parts.iter().copied().zip(simulated.iter().copied()).collect(),
            line: parts.iter().copied().zip(exact.iter().copied()).collect(),
        });
        columns.push((exact, simulated, fitted));
    }
    for i in (0..parts.len()).step_by(4) {
        write!(report, "| {} |", parts[i])?;
        for (exact, simulated, fitted) in &columns {
            let fit = fitted[i].map_or("-".to_owned(), |fit| format!("{fit:.3}"));
            write!(report, " {:.3} ({:.3}, {fit}) |", exact[i], simulated[i])?;
        }
        report.push('\n');
    }
    report.push_str("\n![Figure 4](landscape_4.svg)\n");
    let what = "dots: 50 maps each, lines: exact means";
    draw_curves(&out.join("landscape_4.svg"), ("S / Smax", what), (1.0, 2.0), &series)
}

fn looks(out: &Path, report: &mut String) -> Result {
    report.push_str(
        "\n## One entropy, one Total Edge, four looks\n\n\
         S = 1.9 nats and TE = 1000 with 9 classes: the same counts and the same number of edges \
         in every map.\n\n![Four looks](landscape_looks.svg)\n",
    );
    let mut maps = Vec::new();
    for algorithm in [Algorithm::Mixed, Algorithm::Automaton, Algorithm::Bands, Algorithm::Smooth] {
        let spec = LandscapeSpec { algorithm, total_edge: Some(1000), ..Default::default() };
        let map = spec.generate(Seed(4))?;
        maps.push((format!("{}: TE = {}", algorithm.name(), map.total_edge()), map));
    }
    draw_maps(&out.join("landscape_looks.svg"), &maps)
}

/// Draws maps side by side, each below its title; runs of equal cells are one rectangle.
fn draw_maps(path: &Path, maps: &[(String, Landscape)]) -> Result {
    const CELL: i32 = 6;
    let side = SIDE as i32 * CELL;
    let size = ((side + 20) * maps.len() as i32, side + 40);
    let area = SVGBackend::new(path, (size.0 as u32, size.1 as u32)).into_drawing_area();
    area.fill(&WHITE)?;
    for (k, (title, map)) in maps.iter().enumerate() {
        let left = 10 + (side + 20) * k as i32;
        area.draw(&Text::new(title.clone(), (left, 10), ("sans-serif", 13)))?;
        let classes = map.counts().len() as u16;
        for (r, row) in map.cells().chunks_exact(map.cols()).enumerate() {
            let (mut c, top) = (0, 30 + r as i32 * CELL);
            for run in row.chunk_by(|a, b| a == b) {
                let colour = rgb(palette::ordered_class(run[0], classes));
                let (x, width) = (left + c * CELL, run.len() as i32 * CELL);
                let corners = [(x, top), (x + width, top + CELL)];
                area.draw(&Rectangle::new(corners, colour.filled()))?;
                c += run.len() as i32;
            }
        }
    }
    area.present()?;
    Ok(())
}

fn rgb(Srgb([red, green, blue]): Srgb) -> RGBColor {
    RGBColor(red, green, blue)
}

/// Measured points and a curve to compare them with.
struct Series {
    name: String,
    points: Vec<(f64, f64)>,
    line: Vec<(f64, f64)>,
}

fn draw_curves(
    path: &Path,
    (axis, caption): (&str, &str),
    (right, top): (f64, f64),
    series: &[Series],
) -> Result {
    let area = SVGBackend::new(path, (800, 560)).into_drawing_area();
    area.fill(&WHITE)?;
    let mut chart = ChartBuilder::on(&area)
        .caption(caption, ("sans-serif", 16))
        .margin(12)
        .x_label_area_size(40)
        .y_label_area_size(50)
        .build_cartesian_2d(0.0..right, 0.0..top)?;
    chart.configure_mesh().x_desc(axis).y_desc("TED").draw()?;
    for (series, colour) in series.iter().zip(COLOURS.map(rgb)) {
        chart.draw_series(LineSeries::new(series.line.iter().copied(), colour.stroke_width(2)))?;
        chart
            .draw_series(series.points.iter().map(|&at| Circle::new(at, 4, colour.filled())))?
            .label(series.name.clone())
            .legend(move |(x, y)| Circle::new((x + 10, y), 4, colour.filled()));
    }
    chart
        .configure_series_labels()
        .background_style(WHITE)
        .border_style(BLACK)
        .position(SeriesLabelPosition::LowerRight)
        .draw()?;
    area.present()?;
    Ok(())
}
