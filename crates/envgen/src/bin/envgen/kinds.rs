//! `envgen kinds`.

use std::io::{self, Write};
use std::process::ExitCode;

use clap::Args;
use envgen::WorldKind;
use envgen::scenario::ScenarioSpec;
use envgen::settings::{Setting, groups};
use serde_json::{Value, json};

use crate::failure::Failure;

#[derive(Args)]
pub(crate) struct Arguments {
    /// Prints JSON: the kinds of worlds, or one of them, or `scenario`.
    #[arg(long)]
    json: bool,

    /// Lists only this kind, or the settings of doors, people and smoke with `scenario`.
    kind: Option<String>,
}

/// The name by which the settings of doors, people and smoke are listed alone.
const SCENARIO: &str = "scenario";

/// What a scenario is.
const SCENARIO_SUMMARY: &str = "doors, people and smoke, for `generate` with any kind";

pub(crate) fn run(arguments: &Arguments) -> Result<ExitCode, Failure> {
    let is_scenario = arguments.kind.as_deref() == Some(SCENARIO);
    let kinds = match &arguments.kind {
        Some(_) if is_scenario => Vec::new(),
        Some(name) => {
            vec![name.parse().map_err(|error| Failure::Usage(format!("{error}, or {SCENARIO}")))?]
        }
        None => WorldKind::ALL.to_vec(),
    };
    let mut out = io::stdout().lock();
    if arguments.json {
        let mut list: Vec<Value> = kinds.iter().map(|kind| describe(*kind)).collect();
        if is_scenario {
            list.push(describe_scenario());
        }
        serde_json::to_writer_pretty(&mut out, &list)?;
        writeln!(out)?;
        return Ok(ExitCode::SUCCESS);
    }
    for kind in kinds {
        writeln!(out, "{kind}: {}", kind.summary())?;
        list(kind.settings(), &kind.default_spec().settings_json(), &mut out)?;
        for rule in kind.rules() {
            writeln!(out, "  together: {rule}")?;
        }
        writeln!(out)?;
    }
    if is_scenario || arguments.kind.is_none() {
        writeln!(out, "{SCENARIO}: {SCENARIO_SUMMARY}")?;
        list(ScenarioSpec::SETTINGS, &ScenarioSpec::default().settings_json(), &mut out)?;
    } else {
        writeln!(out, "`envgen kinds {SCENARIO}` lists the settings of doors, people and smoke.")?;
    }
    Ok(ExitCode::SUCCESS)
}

/// Prints settings with their limits and defaults, those of a group below its name.
fn list(settings: &'static [Setting], defaults: &Value, out: &mut impl Write) -> io::Result<()> {
    let column = settings.iter().map(|setting| setting.name.len()).max().unwrap_or(0);
    for (group, settings) in groups(settings) {
        if let Some(group) = group {
            writeln!(out, "  [{group}]")?;
        }
        for setting in settings {
            let default = match setting.text_of(&defaults[setting.name]) {
                empty if empty.is_empty() => "empty".to_owned(),
                default => default,
            };
            let unit = if setting.unit.is_empty() { "" } else { " " };
            let or_none = if setting.optional { ", or none" } else { "" };
            let example = setting.example.map_or(String::new(), |text| format!(", such as {text}"));
            writeln!(
                out,
                "  {:column$}  {}\n  {:column$}  {}{unit}{}{or_none}{example}; default {default}",
                setting.name, setting.help, "", setting.allowed, setting.unit
            )?;
        }
    }
    Ok(())
}

fn describe(kind: WorldKind) -> Value {
    json!({
        "kind": kind,
        "summary": kind.summary(),
        "value_version": kind.value_version(),
        "settings": describe_settings(kind.settings(), &kind.default_spec().settings_json()),
        "rules": kind.rules(),
    })
}

/// Describes scenarios, which have no value version: a scenario file holds all that is drawn.
fn describe_scenario() -> Value {
    let defaults = ScenarioSpec::default().settings_json();
    json!({
        "kind": SCENARIO,
        "summary": SCENARIO_SUMMARY,
        "settings": describe_settings(ScenarioSpec::SETTINGS, &defaults),
        "rules": [],
    })
}

fn describe_settings(settings: &[Setting], defaults: &Value) -> Vec<Value> {
    let describe = |setting: &Setting| {
        json!({
            "name": setting.name,
            "alias": setting.alias,
            "unit": setting.unit,
            "allowed": setting.allowed_text(),
            "default": defaults[setting.name],
            "help": setting.help,
            "example": setting.example,
            "group": setting.group,
        })
    };
    settings.iter().map(describe).collect()
}
