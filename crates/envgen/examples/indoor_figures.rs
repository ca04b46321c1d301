//! Draws the equivalents of figures 2, 5 and 6 of Zwennes (2011): how an indoor map changes with
//! its difficulty, and two additions of this crate.
//!
//! `cargo run --release --example indoor_figures -- docs/pictures`

use std::error::Error;
use std::fs::{self, File};
use std::io::BufWriter;
use std::path::PathBuf;

use envgen::indoor::{Cycles, IndoorSpec, Layout, Profile};
use envgen::picture::{PictureOptions, write_svg};
use envgen::{Blueprint, Seed, Spec};

fn main() -> Result<(), Box<dyn Error>> {
    let folder: PathBuf =
        std::env::args_os().nth(1).ok_or("expected the output folder as argument")?.into();
    fs::create_dir_all(&folder)?;
    let thesis = |difficulty, cycles| IndoorSpec {
        difficulty,
        cycles,
        profile: Profile::Thesis,
        ..Default::default()
    };
    let figures = [
        ("indoor_2a", "Difficulty 0, cycles allowed", thesis(0.0, Cycles::Allow), 1),
        ("indoor_2b", "Difficulty 10", thesis(10.0, Cycles::Difficulty), 4),
        ("indoor_5", "Difficulty 0, cycles prevented", thesis(0.0, Cycles::Prevent), 1),
        ("indoor_6a", "Difficulty 1", thesis(1.0, Cycles::Difficulty), 2),
        ("indoor_6b", "Difficulty 9", thesis(9.0, Cycles::Difficulty), 5),
        ("indoor_guaranteed", "Difficulty 5, every place reachable", IndoorSpec::default(), 3),
        (
            "indoor_l_system",
            "Difficulty 3, hallways grown by an L-system",
            IndoorSpec { difficulty: 3.0, layout: Layout::LSystem, ..Default::default() },
            2,
        ),
    ];
    for (name, title, spec, seed) in figures {
        let world = spec.generate(Seed(seed))?.to_world();
        let options = PictureOptions { title: Some(title.to_owned()), ..Default::default() };
        let file = File::create(folder.join(name).with_extension("svg"))?;
        write_svg(&world, &options, &mut BufWriter::new(file))?;
    }
    Ok(())
}
