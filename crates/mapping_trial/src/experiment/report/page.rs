//! The whole page.

use maud::{DOCTYPE, Markup, PreEscaped, html};

use super::maps::MapPictures;
use super::numbers::list;
use super::{colors, levels, rules, statistics, trials, words};
use crate::experiment::design::{Design, policy_name};
use crate::experiment::error::ExperimentError;
use crate::experiment::record::Record;
use crate::experiment::stats::Analysis;
use crate::names::Named;
use crate::policy::PolicyKind;
use crate::score::Weights;

const STYLE: &str = include_str!("report.css");

const TITLE: &str = "Do the rules make maps difficult?";

/// The page as HTML.
pub(super) fn page(
    design: &Design,
    records: &[&Record],
    analysis: &Analysis,
    maps: &[MapPictures],
) -> Result<String, ExperimentError> {
    let content = html! {
        (lead(design, records))
        div.findings {
            ul {
                @for finding in words::findings(design, analysis) {
                    li { (finding) }
                    "\n"
                }
            }
        }
        (levels::section(design, analysis)?)
        (statistics::section(design, analysis))
        (rules::section(design, analysis)?)
        (rules::weights(analysis))
        (trials::ends(design, analysis))
        (trials::maps(design, maps))
        (trials::list(design, records))
        (method(design))
    };
    Ok(html_page(TITLE, &content))
}

/// A self-contained page.
pub(crate) fn html_page(title: &str, content: &Markup) -> String {
    let page = html! {
        (DOCTYPE)
        html lang="en" {
            head {
                meta charset="utf-8";
                meta name="viewport" content="width=device-width,initial-scale=1";
                title { (title) }
                style { (PreEscaped(colors::variables())) (PreEscaped(STYLE)) }
            }
            "\n"
            body {
                main {
                    h1 { (title) }
                    (content)
                }
            }
        }
    };
    page.into_string() + "\n"
}

fn names(policies: &[PolicyKind]) -> String {
    list(&policies.iter().map(|&kind| policy_name(kind).to_owned()).collect::<Vec<_>>())
}

fn lead(design: &Design, records: &[&Record]) -> Markup {
    let levels: Vec<String> = design.levels.iter().map(f64::to_string).collect();
    let metres = f64::from(design.size) * design.spec(design.levels[0]).cell_size;
    html! {
        p.lead {
            (records.len()) " trials in a simulator, in which policies map indoor worlds of the levels "
            (list(&levels)) " and their maps are scored against the worlds. The experiment of O. Zwennes, "
            i { "Adaptive Indoor Map Generator for USARSim" }
            " (2011), which asked people, is replayed."
        }
        p.note {
            "The paper's design: " (design.replay.maps) " maps per level, each once by "
            (names(&design.replay.policies)) ". The larger design: " (design.maps)
            " maps per level, " (design.noise_seeds) " noise seed"
            @if design.noise_seeds != 1 { "s" }
            " each, by " (names(&design.policies)) ". Maps of " (design.size) " x " (design.size)
            " cells (" (metres) " m square), estimated by " (design.slam.name().unwrap_or("custom"))
            ", laser " (design.laser.name().unwrap_or("custom"))
            ", odometry " (design.odometry.name().unwrap_or("custom"))
            ", time limit " (time_limit(design)) "."
        }
    }
}

fn method(design: &Design) -> Markup {
    let e = |index: &str| html! { "e" sub { (index) } };
    let (w, share) = (Weights::default(), |weight: f64| format!("{weight:.2} "));
    html! {
        h2 { "Method" }
        p.note {
            "Map " i { "k" } " of level " i { "l" } " is generated with seed "
            (design.seed.0.wrapping_mul(1_000_000)) " + 10000 " i { "l" } " + " i { "k" }
            ", its noise " i { "j" } " with 1000 times that seed + " i { "j" }
            ". The robot is a P3-AT with the noise of its laser and wheels; the world is unknown to it. \
             M = 10 (" (share(w.wall)) (e("wall")) " + " (share(w.navigability)) (e("use")) " + "
            (share(w.pose)) (e("pose")) " + " (share(w.coverage)) (e("cov")) "), N = 10 ("
            (share(w.time)) (e("time")) " + " (share(w.reach)) (e("cov")) " + " (share(w.collisions))
            (e("hit")) " + " (share(w.turning)) (e("turn")) "), D = " (share(w.mapping)) "M + "
            (share(w.navigation)) "N. The same design gives the same page to the \
             last byte."
        }
    }
}

/// The time limit of a design's trials.
fn time_limit(design: &Design) -> String {
    match design.time_per_area {
        Some(per_area) => format!("{per_area} s for each square metre"),
        None => format!("{} s", design.time_limit),
    }
}
