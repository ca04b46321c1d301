//! `envgen check`.

use std::io::{self, Write};
use std::path::PathBuf;
use std::process::ExitCode;

use clap::Args;
use envgen::World;
use envgen::certificate::{Claim, Verdict, verify_claims};
use envgen::difficulty::Platform;
use envgen::reproduction::{Reproduction, reproduce};
use envgen::scenario::{BehindDoor, Scenario};
use envgen::world::SurfaceKind;

use crate::failure::Failure;
use crate::moving::read_scenario;
use crate::progress::steps;
use crate::source::WorldFile;

#[derive(Args)]
pub(crate) struct Arguments {
    #[command(flatten)]
    file: WorldFile,

    /// A scenario: a RON file of doors, people and smoke. Promises are verified with every door open, and places that
    /// can be reached only through a single door are listed.
    #[arg(long, value_name = "FILE.ron")]
    scenario: Option<PathBuf>,
}

pub(crate) fn run(arguments: &Arguments) -> Result<ExitCode, Failure> {
    let world = arguments.file.read()?;
    let scenario = match &arguments.scenario {
        Some(path) => Some(read_scenario(path, &world)?),
        None => None,
    };
    let (checked, reproduction, behind) = {
        let steps = steps(world.certificate.len() + 1 + usize::from(scenario.is_some()));
        let doors = scenario.as_ref().map(|scenario| {
            steps.begin("what depends on doors");
            doors(&world, scenario)
        });
        let (open, behind) = doors.transpose()?.unzip();
        let open = open.as_ref().unwrap_or(&world);
        let checked = open.certificate.iter().flat_map(|claim| {
            steps.begin(claim.to_string());
            verify_claims(open, &[*claim])
        });
        let checked: Vec<_> = checked.collect();
        steps.begin("the world of its spec and seed");
        (checked, reproduce(&world), behind.unwrap_or_default())
    };
    let all_hold = checked.iter().all(|(_, verdict)| *verdict == Verdict::Holds);
    let is_trusted = all_hold && reproduction.is_credible();
    match print(&checked, &reproduction, &behind) {
        // A reader that stops after the first line still gets the right exit code.
        Err(Failure::ReaderGone) | Ok(()) => Ok(ExitCode::from(u8::from(!is_trusted))),
        Err(failure) => Err(failure),
    }
}

/// The world with every door open, and what is behind single doors.
fn doors(world: &World, scenario: &Scenario) -> Result<(World, Vec<String>), Failure> {
    let radius = world.certificate.iter().find_map(|claim| match claim {
        Claim::Connected { radius } | Claim::EveryPlaceReachable { radius } => Some(*radius),
        _ => None,
    });
    let radius = radius.unwrap_or(Platform::default().circumscribed_radius);
    let open = scenario.with_open_doors(world)?;
    let behind = match scenario.behind_doors(world, radius) {
        // The scenario fits the world: it is too large.
        Err(error) => vec![format!("not decided what depends on single doors: {error}")],
        Ok(behind) => behind.iter().map(|behind| describe(world, scenario, behind)).collect(),
    };
    Ok((open, behind))
}

fn describe(world: &World, scenario: &Scenario, behind: &BehindDoor) -> String {
    let room = |&room: &u32| format!("room {room} ({})", world.rooms[room as usize].name);
    let mut places: Vec<String> = behind.rooms.iter().map(room).collect();
    let kind = |&index: &u32| match world.surfaces[index as usize].kind {
        SurfaceKind::OpenArea => format!("surfaces[{index}] (open area)"),
        _ => format!("surfaces[{index}] (hallway)"),
    };
    places.extend(behind.hallways.iter().map(kind));
    if behind.goal {
        places.push("the goal".to_owned());
    }
    let doorway = scenario.doors[behind.door].doorway;
    format!("only through doors[{}] in doorway {doorway}: {}", behind.door, places.join(", "))
}

fn print(
    checked: &[(Claim, Verdict)],
    reproduction: &Reproduction,
    doors: &[String],
) -> Result<(), Failure> {
    let mut out = io::stdout().lock();
    writeln!(out, "holds: every invariant of a world")?;
    for (claim, verdict) in checked {
        match verdict.doubt() {
            Some(doubt) => writeln!(out, "{}: {claim} ({doubt})", verdict.name())?,
            None => writeln!(out, "{}: {claim}", verdict.name())?,
        }
    }
    if checked.is_empty() {
        writeln!(out, "nothing promised: the certificate is empty")?;
    }
    writeln!(out, "{reproduction}")?;
    for door in doors {
        writeln!(out, "{door}")?;
    }
    Ok(())
}
