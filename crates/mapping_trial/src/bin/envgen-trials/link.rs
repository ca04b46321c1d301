//! The subcommand `envgen-trials link`.

use std::collections::BTreeSet;
use std::error::Error;
use std::fmt::Write;
use std::fs::File;
use std::path::{Path, PathBuf};

use clap::Args;
use envgen::calibration::Dials;
use envgen::located::Locate;
use envgen::text_file;
use mapping_trial::difficulty::Panel;
use mapping_trial::experiment::stats::Interval;
use mapping_trial::experiment::survey::Condition;
use mapping_trial::feedback::{
    DifficultySource, LinkError, PanelDifficulty, RatedWorld, Rating, RatingLink,
};
use mapping_trial::names::printable;
use mapping_trial::robot::Robot;
use mapping_trial::trial::{TrialLog, TrialReport, TrialSettings};
use serde::Serialize;

use crate::{json, stdout};

#[derive(Args)]
pub(crate) struct Arguments {
    /// The report.json of each session; its log.json is in the same folder. To fit the ratings of one person, give
    /// the sessions of this person only. Sessions in folders whose names end with _training are left out, because
    /// they showed the true world.
    #[arg(value_name = "REPORT.json", required = true)]
    reports: Vec<PathBuf>,

    /// Prints JSON.
    #[arg(long)]
    json: bool,
}

/// A session.
#[derive(Serialize)]
struct Session {
    report: PathBuf,
    operator: String,
    /// Description of the world, such as `indoor, seed 3`.
    world: String,
    world_digest: String,
    ratings: Dials<Rating>,
    /// The difficulty by the reference panel.
    panel: PanelDifficulty,
    /// The settings, such as the robot's body, that are those of no condition of the panel.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    unlike_panel: Vec<&'static str>,
}

/// The output.
#[derive(Serialize)]
struct Links {
    sessions: Vec<Session>,
    /// Sessions that are not linked, with the reason.
    left_out: Vec<String>,
    /// The link of each rating.
    links: Dials<DialLink>,
}

/// The link of a rating.
#[derive(Serialize)]
struct DialLink {
    #[serde(skip_serializing_if = "Option::is_none")]
    link: Option<RatingLink>,
    /// Why the ratings are not linked.
    #[serde(skip_serializing_if = "Option::is_none")]
    failure: Option<String>,
    /// The sessions' ratings on the scale of the panel.
    linked: Vec<Interval>,
}

pub(crate) fn run(arguments: &Arguments) -> Result<(), Box<dyn Error>> {
    let (mut sessions, mut left_out) = (Vec::new(), Vec::new());
    let mut given = BTreeSet::new();
    for path in &arguments.reports {
        let is_new = given.insert(path.canonicalize().in_file(path)?);
        match session(path)? {
            Ok(_) if !is_new => left_out.push(format!("{}: it is given twice", path.display())),
            Ok(session) => sessions.push(session),
            Err(reason) => left_out.push(format!("{}: {reason}", path.display())),
        }
    }
    let ratings = |rating: fn(&Session) -> Rating, difficulty: fn(&Session) -> f64| {
        DialLink::new(&sessions, rating, difficulty)
    };
    let links = Dials {
        difficulty: ratings(|s| s.ratings.difficulty, |s| s.panel.dials.difficulty.value),
        mapping: ratings(|s| s.ratings.mapping, |s| s.panel.dials.mapping.value),
        navigation: ratings(|s| s.ratings.navigation, |s| s.panel.dials.navigation.value),
    };
    let links = Links { sessions, left_out, links };
    if arguments.json { json::print(&links) } else { Ok(stdout::print(&text(&links))?) }
}

/// Reads a session, or returns why it is not linked.
fn session(path: &Path) -> Result<Result<Session, String>, Box<dyn Error>> {
    let text = text_file::read(path).in_file(path)?;
    let report = TrialReport::from_json(&text).in_file(path)?;
    // The absolute path is needed, since a name alone has no folder.
    let whole = std::path::absolute(path).in_file(path)?;
    let folder = whole.parent().and_then(Path::file_name).unwrap_or_default();
    if folder.to_string_lossy().ends_with("_training") {
        return Ok(Err("the true world was shown".to_owned()));
    }
    let Some(feedback) = report.feedback.clone() else {
        return Ok(Err("the form is not filled".to_owned()));
    };
    if report.is_form_measured() {
        return Ok(Err("a program drove, and filled the form from measurements".to_owned()));
    }
    if report.scenario.is_some() {
        let reason = "the world had doors that move, people or smoke, which the panel did not meet";
        return Ok(Err(reason.to_owned()));
    }
    let log_path = path.with_file_name("log.json");
    let mut log = File::open(&log_path).in_file(&log_path)?;
    let world = TrialLog::read(&mut log).in_file(&log_path)?.world.world().in_file(&log_path)?;
    if world.digest().to_string() != report.world_digest {
        return Err(
            format!("{}: this is not the world of {}", log_path.display(), path.display()).into()
        );
    }
    let panel = match PanelDifficulty::of(&world) {
        Ok(panel) => panel,
        Err(error) => return Ok(Err(error.to_string())),
    };
    Ok(Ok(Session {
        report: path.to_owned(),
        ratings: feedback.ratings(),
        operator: feedback.name,
        world: world.provenance.name(),
        world_digest: report.world_digest,
        unlike_panel: unlike_panel(&report.settings),
        panel,
    }))
}

/// The names of the settings that make a session another task than the panel's.
fn unlike_panel(settings: &TrialSettings) -> Vec<&'static str> {
    let panel = Panel::reference();
    let is_in = |is_same: &dyn Fn(&Condition) -> bool| panel.conditions.iter().any(is_same);
    // The time limit may have raised the charge.
    let has_body = |one: &Condition| {
        let battery = one.robot.battery;
        Robot { battery, ..settings.body.clone() } == one.robot
    };
    let all = [
        ("robots", settings.robots == 1),
        ("body", is_in(&has_body)),
        ("laser", is_in(&|one| one.laser == settings.laser)),
        ("odometry", is_in(&|one| one.odometry == settings.odometry)),
    ];
    all.into_iter().filter(|(_, is_known)| !is_known).map(|(name, _)| name).collect()
}

impl DialLink {
    fn new(
        sessions: &[Session],
        rating: fn(&Session) -> Rating,
        difficulty: fn(&Session) -> f64,
    ) -> Self {
        let rated = |session: &Session| (rating(session), difficulty(session));
        let rated: Vec<RatedWorld<'_>> = sessions
            .iter()
            .map(|session| {
                let (rating, difficulty) = rated(session);
                RatedWorld { world: &session.world_digest, rating, difficulty }
            })
            .collect();
        let link: Result<RatingLink, LinkError> = RatingLink::new(&rated);
        let linked = link.iter().flat_map(|link| rated.iter().map(|one| link.apply(one.rating)));
        let linked = linked.collect();
        match link {
            Ok(link) => DialLink { link: Some(link), failure: None, linked },
            Err(error) => DialLink { link: None, failure: Some(error.to_string()), linked },
        }
    }
}

fn text(links: &Links) -> String {
    let mut text = String::new();
    let Links { sessions, left_out, links } = links;
    let dials = links.as_ref().named();
    writeln!(
        text,
        "rating, linked rating with its 95 % interval, and difficulty by the reference panel"
    )
    .ok();
    for (i, session) in sessions.iter().enumerate() {
        let source = match session.panel.source {
            DifficultySource::Measured => "measured",
            DifficultySource::Predicted => "predicted",
        };
        writeln!(
            text,
            "\n{} by {} ({})",
            printable(&session.world),
            printable(&session.operator),
            printable(&session.report.to_string_lossy())
        )
        .ok();
        let panel = session.panel.dials.named();
        for (j, (name, rating)) in session.ratings.named().into_iter().enumerate() {
            let linked = dials[j].1.linked.get(i).map_or_else(String::new, |linked| {
                format!("{:5.1} ({:.1} to {:.1})", linked.value, linked.low, linked.high)
            });
            let difficulty = panel[j].1;
            writeln!(
                text,
                "{name:>12} {:4.1} {linked:>22}  {source} {:.1} +- {:.1}",
                rating.value(),
                difficulty.value,
                difficulty.standard_error
            )
            .ok();
        }
        if !session.unlike_panel.is_empty() {
            let names = session.unlike_panel.join(", ");
            writeln!(text, "{:>12} not as in the panel: {names}", "settings").ok();
        }
    }
    text.push('\n');
    for (name, dial) in dials {
        let line = match &dial.link {
            Some(RatingLink { link, sessions, correlation, .. }) => format!(
                "{:.2} + {:.2} x rating, from {sessions} sessions in {} worlds, correlation {correlation:.2}",
                link.intercept, link.slope, link.maps
            ),
            None => format!("not linked: {}", dial.failure.as_deref().unwrap_or_default()),
        };
        writeln!(text, "{name:>12}: {line}").ok();
        if dial.link.is_some_and(|link| link.correlation <= 0.0) {
            let reason =
                "the ratings do not rise with the difficulty, so the linked ones say nothing";
            writeln!(text, "{:>12}  {reason}", "").ok();
        }
    }
    for reason in left_out {
        writeln!(text, "left out: {}", printable(reason)).ok();
    }
    text
}
