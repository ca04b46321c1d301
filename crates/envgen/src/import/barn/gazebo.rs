//! Reading the cylinders of a Gazebo world.

use glam::DVec2;
use quick_xml::Reader;
use quick_xml::events::Event;

use super::PlanError;
use crate::geometry::Pose;
use crate::world::MAX_COORDINATE;

const FORMAT: &str = "a Gazebo world of cylinders";

/// The greatest number of cylinders that are read.
const MAX_CYLINDERS: usize = 1 << 18;

/// The greatest roll and pitch of an upright cylinder in radians. Gazebo saves models slightly tilted after it
/// simulated their contacts.
const MAX_TILT: f64 = 1e-3;

/// The deepest nesting of elements that is read.
const MAX_DEPTH: usize = 32;

/// The path of elements to the geometry of a model's collision.
const GEOMETRY: [&str; 6] = ["sdf", "world", "model", "link", "collision", "geometry"];

/// A cylinder of a Gazebo world.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cylinder {
    /// Centre of the cylinder in metres.
    pub center: DVec2,
    /// Radius of the cylinder in metres.
    pub radius: f64,
}

/// What was read of a model so far.
#[derive(Default)]
struct Model {
    pose: String,
    /// Poses of the last link and of the last collision in it.
    link: [String; 2],
    /// Poses of the link and the collision that contain the geometry.
    around: [String; 2],
    radius: String,
    /// The geometry of the model's collision.
    geometry: Option<String>,
    /// Whether the geometry is in this link, and in this collision.
    is_in_link: bool,
    is_in_collision: bool,
}

/// Reads the cylinders of the models of a Gazebo world. Models that are planes, and everything else in the world,
/// are left out.
///
/// # Errors
/// When the text is not the XML of a world, or when a model stops a robot and is not a single upright cylinder.
pub fn read_cylinders(text: &str) -> Result<Vec<Cylinder>, PlanError> {
    let mut reader = Reader::from_str(text);
    let mut path: Vec<String> = Vec::new();
    let (mut cylinders, mut model, mut has_world) = (Vec::new(), Model::default(), false);
    loop {
        let event = reader.read_event().map_err(|error| {
            PlanError::syntax(FORMAT, format!("{error} at byte {}", reader.error_position()))
        })?;
        let (start, is_empty) = match event {
            Event::Start(start) => (start, false),
            Event::Empty(start) => (start, true),
            Event::Text(text) => {
                let names: Vec<&str> = path.iter().map(String::as_str).collect();
                let into = match *names {
                    ["sdf", "world", "model", "pose"] => &mut model.pose,
                    ["sdf", "world", "model", "link", "pose"] => &mut model.link[0],
                    ["sdf", "world", "model", "link", "collision", "pose"] => &mut model.link[1],
                    [
                        "sdf",
                        "world",
                        "model",
                        "link",
                        "collision",
                        "geometry",
                        "cylinder",
                        "radius",
                    ] => &mut model.radius,
                    _ => continue,
                };
                into.push_str(&text);
                continue;
            }
            Event::End(_) => {
                if path == ["sdf", "world", "model", "link", "collision"]
                    && std::mem::take(&mut model.is_in_collision)
                {
                    model.around[1].clone_from(&model.link[1]);
                }
                if path == ["sdf", "world", "model", "link"]
                    && std::mem::take(&mut model.is_in_link)
                {
                    model.around[0].clone_from(&model.link[0]);
                }
                if path == ["sdf", "world", "model"] {
                    finish(std::mem::take(&mut model), &mut cylinders)?;
                }
                path.pop();
                continue;
            }
            Event::Eof if path.is_empty() => break,
            Event::Eof => {
                return Err(PlanError::syntax(FORMAT, "it ends inside an element"));
            }
            Event::DocType(_) => {
                return Err(PlanError::syntax(FORMAT, "it has a document type"));
            }
            _ => continue,
        };
        let name = start.name().as_ref().to_owned();
        let depth = path.len();
        has_world |= depth == 1 && path[0] == "sdf" && name == "world";
        if path == GEOMETRY {
            if model.geometry.is_some() {
                return Err(PlanError::value("geometry", name, "one for each model"));
            }
            model.geometry = Some(name.clone());
            (model.is_in_link, model.is_in_collision) = (true, true);
        }
        if path == ["sdf", "world", "model"] && name == "link" {
            model.link = Default::default();
        }
        if path == ["sdf", "world", "model", "link"] && name == "collision" {
            model.link[1].clear();
        }
        if depth == MAX_DEPTH {
            let allowed = format!("at most {MAX_DEPTH} elements in each other");
            return Err(PlanError::value(&name, "one deeper", allowed));
        }
        if !is_empty {
            path.push(name);
        }
    }
    if !has_world {
        return Err(PlanError::syntax(FORMAT, "it has no `world` in an `sdf`"));
    }
    Ok(cylinders)
}

fn finish(model: Model, cylinders: &mut Vec<Cylinder>) -> Result<(), PlanError> {
    match model.geometry.as_deref() {
        None | Some("plane") => return Ok(()),
        Some("cylinder") => {}
        Some(other) => return Err(PlanError::value("geometry", other, "`cylinder` or `plane`")),
    }
    if cylinders.len() == MAX_CYLINDERS {
        let allowed = format!("at most {MAX_CYLINDERS}");
        return Err(PlanError::value("model", "more models", allowed));
    }
    let number = |text: &str| text.parse::<f64>().ok().filter(|value| value.is_finite());
    let short = |text: &str| format!("`{}`", text.trim().chars().take(80).collect::<String>());
    // That of the model, of its link in it, and of the collision in that; those that are not given are zero.
    let mut pose = Pose::default();
    let [link, collision] = &model.around;
    for text in [&model.pose, link, collision].into_iter().filter(|text| !text.trim().is_empty()) {
        let numbers: Option<Vec<f64>> = text.split_whitespace().map(number).collect();
        let Some(&[x, y, _, roll, pitch, yaw]) = numbers.as_deref() else {
            return Err(PlanError::value("pose", short(text), "six finite numbers"));
        };
        let tilt = roll.abs().max(pitch.abs());
        if x.abs().max(y.abs()) > MAX_COORDINATE || tilt > MAX_TILT {
            let allowed = format!(
                "up to {MAX_COORDINATE:e} m from the axes, and upright: roll and pitch are up to {MAX_TILT} rad"
            );
            return Err(PlanError::value("pose", short(text), allowed));
        }
        pose = pose.compose(Pose::new(x, y, yaw));
    }
    let radius = number(model.radius.trim()).filter(|radius| (1e-3..=1e3).contains(radius));
    let radius = radius
        .ok_or_else(|| PlanError::value("radius", short(&model.radius), "from 0.001 to 1000 m"))?;
    cylinders.push(Cylinder { center: pose.position, radius });
    Ok(())
}
