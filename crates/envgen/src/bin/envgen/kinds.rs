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
    /// Prints JSON.
    #[arg(long)]
    json: bool,

    /// Lists only this kind.
    kind: Option<String>,
}

pub(crate) fn run(arguments: &Arguments) -> Result<ExitCode, Failure> {
    let kinds = match &arguments.kind {
        Some(name) => vec![name.parse()?],
        None => WorldKind::ALL.to_vec(),
    };
    let mut out = io::stdout().lock();
    if arguments.json {
        let list: Vec<Value> = kinds.iter().map(|kind| describe(*kind)).collect();
        serde_json::to_writer_pretty(&mut out, &list)?;
        writeln!(out)?;
        return Ok(ExitCode::SUCCESS);
    }
    for (i, kind) in kinds.into_iter().enumerate() {
        if i > 0 {
            writeln!(out)?;
        }
        writeln!(out, "{kind}: {}", kind.summary())?;
        list(kind.settings(), &kind.default_spec().settings_json(), &mut out)?;
        for rule in kind.rules() {
            writeln!(out, "  together: {rule}")?;
        }
    }
    if arguments.kind.is_none() {
        writeln!(out, "\nscenario, for `generate` with any kind: doors, people and smoke.")?;
        list(ScenarioSpec::SETTINGS, &ScenarioSpec::default().settings_json(), &mut out)?;
    } else {
        writeln!(out, "\n`envgen kinds` also lists the settings of doors, people and smoke.")?;
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
    let defaults = kind.default_spec().settings_json();
    let settings: Vec<Value> = kind
        .settings()
        .iter()
        .map(|setting| {
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
        })
        .collect();
    json!({
        "kind": kind,
        "summary": kind.summary(),
        "value_version": kind.value_version(),
        "settings": settings,
        "rules": kind.rules(),
    })
}
