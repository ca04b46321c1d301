//! Specs drawn from all that the settings allow.

use envgen::settings::{Allowed, Setting};
use envgen::{Seed, Stream, WorldKind, WorldSpec};
use serde_json::{Value, json};

/// The most that making and checking a world may cost, so that it takes a fraction of a second.
pub(crate) const MAX_COST: f64 = 3000.0;

/// Settings of roads that are rarely drawn: hardly any seed has a road that meets them.
const RARE: [&str; 4] = ["end_x", "end_y", "area", "closed"];

/// What a world costs: its parts, cells or points; indoors, where places are looked for in squares
/// along the walls, four for each metre of a cell's side, and a hundred where contents are moved.
fn cost(spec: &WorldSpec) -> f64 {
    match spec {
        WorldSpec::Indoor(indoor) => {
            let metres = f64::from(indoor.width) * f64::from(indoor.height) * indoor.cell_size;
            metres * if indoor.clearance.is_some() { 100.0 } else { 4.0 }
        }
        other => other.work(),
    }
}

/// A valid spec of a kind of at most a [cost](MAX_COST): half of its settings drawn, the others at their defaults.
///
/// Numbers are uniform in their logarithm over the whole range that their setting allows, so that a
/// millimetre is as common as a kilometre. Where settings do not go together, the one that the error
/// names is drawn again or set to its default.
pub(crate) fn random_spec(kind: WorldKind, seed: u64, max_cost: f64) -> WorldSpec {
    for attempt in 0.. {
        let mut stream = Seed(seed).attempt(kind.name(), 0, attempt);
        let mut settings = kind.default_spec().settings_json();
        for setting in plane(kind) {
            let share = if RARE.contains(&setting.name) { 0.05 } else { 0.5 };
            if stream.chance(share) {
                settings[setting.name] = draw(setting, &settings, &mut stream);
            }
        }
        // Plans do not depend on heights.
        let mut heights = Seed(seed).attempt("heights", 0, attempt);
        for setting in kind.settings().iter().filter(|setting| is_height(setting)) {
            if heights.chance(0.5) {
                settings[setting.name] = draw(setting, &settings, &mut heights);
            }
        }
        if let Some(spec) = repaired(kind, settings, max_cost, &mut stream) {
            return spec;
        }
    }
    unreachable!("the defaults are valid, and drawn at times")
}

/// Whether a setting is a height of parts, which has draws of its own.
fn is_height(setting: &Setting) -> bool {
    setting.name.ends_with("_height")
}

/// The settings that decide the plan.
fn plane(kind: WorldKind) -> impl Iterator<Item = &'static Setting> {
    kind.settings().iter().filter(|setting| !is_height(setting))
}

fn repaired(
    kind: WorldKind,
    mut settings: Value,
    max_cost: f64,
    stream: &mut Stream,
) -> Option<WorldSpec> {
    let defaults = kind.default_spec().settings_json();
    for _ in 0..60 {
        // What is too large is not worth the checks.
        let wrong = match spec_of(kind, &settings) {
            Ok(spec) if cost(&spec) <= max_cost => match spec.validate() {
                Ok(()) => return Some(spec),
                Err(error) => error.field,
            },
            _ => String::new(),
        };
        // Too much work, or a sum or product of settings: any of them may be to blame.
        let named = |setting: &&Setting| wrong.split([' ', '+', '*']).any(|w| w == setting.name);
        let mut to_blame: Vec<_> = kind.settings().iter().filter(named).collect();
        if to_blame.is_empty() || stream.chance(0.3) {
            let settings: Vec<_> = plane(kind).collect();
            to_blame = vec![settings[stream.below(settings.len() as u64) as usize]];
        }
        for setting in to_blame {
            settings[setting.name] = match stream.chance(0.5) {
                true => draw(setting, &settings, stream),
                false => defaults[setting.name].clone(),
            };
        }
    }
    None
}

fn spec_of(kind: WorldKind, settings: &Value) -> serde_json::Result<WorldSpec> {
    serde_json::from_value(json!({ kind.name(): settings }))
}

fn draw(setting: &Setting, settings: &Value, stream: &mut Stream) -> Value {
    // Rooms are data: the built-in ones represent them.
    if setting.name == "catalogue" {
        return Value::Null;
    }
    match setting.allowed {
        // Wider ones do not fit into the map.
        Allowed::Integer { .. } if setting.name.starts_with("spacing") => {
            let size = if setting.name == "spacing_h" { "width" } else { "height" };
            (3 + stream.below(settings[size].as_u64().unwrap_or(1))).into()
        }
        // Attempts cost time and do not change the result.
        Allowed::Integer { .. } if setting.name == "attempts" => stream.below(20).max(1).into(),
        Allowed::Integer { min, max } => {
            let drawn = spread(min as f64, max as f64, 1.0, stream).round();
            (drawn as u64).clamp(min, max).into()
        }
        Allowed::Number { min, max } => spread(min, max, 1e-4, stream).into(),
        Allowed::Choice(names) => names[stream.below(names.len() as u64) as usize].into(),
        Allowed::Flag => stream.chance(0.5).into(),
        Allowed::List(_) | Allowed::Other(_) => draw_other(setting.name, settings, stream),
    }
}

/// A number of a range, uniform in its logarithm; the ends and 0 more often.
fn spread(min: f64, max: f64, least: f64, stream: &mut Stream) -> f64 {
    let (low, high) = (min.max(least), max);
    let drawn = libm::exp(stream.between(libm::log(low), libm::log(high)));
    match stream.below(16) {
        0 => min,
        1 => max,
        2 => stream.between(min, max),
        _ if min < 0.0 && stream.chance(0.5) => (-drawn).max(min),
        _ => drawn.clamp(min, max),
    }
}

fn draw_other(name: &str, settings: &Value, stream: &mut Stream) -> Value {
    let whole = |name: &str| settings[name].as_u64().unwrap_or(1);
    match name {
        "start" => match stream.below(9) {
            0 => "stationary".into(),
            state => state.into(),
        },
        "density" => {
            let (rows, cols) = (1 + stream.below(4), 1 + stream.below(4));
            let row = |stream: &mut Stream| -> Value {
                let factor = |stream: &mut Stream| stream.below(4) as f64 * stream.unit();
                (0..cols).map(|_| factor(stream)).collect::<Vec<_>>().into()
            };
            (0..rows).map(|_| row(stream)).collect::<Vec<_>>().into()
        }
        "prefabs" => {
            let names = ["straight", "left", "right", "turn"];
            let count = 1 + stream.below(12);
            let drawn = (0..count).map(|_| names[stream.below(4) as usize]);
            drawn.collect::<Vec<_>>().into()
        }
        "alpha" => spread(1e-6, 1e12, 1e-6, stream).into(),
        "speeds" => {
            let speed = |stream: &mut Stream| stream.below(3) as f64 * 0.5;
            (0..whole("classes")).map(|_| speed(stream)).collect::<Vec<_>>().into()
        }
        "rooms" => json!([]),
        _ => Value::Null,
    }
}
