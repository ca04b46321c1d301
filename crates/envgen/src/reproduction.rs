//! Checks whether a world is the one that its spec and seed give.

use std::fmt;

use serde::Deserialize;
use serde_json::Value;

use crate::indoor::{Edit, PlanEditor};
use crate::provenance::Provenance;
use crate::seed::STREAM_ALGORITHM;
use crate::spec::{WorldBlueprint, WorldKind, WorldSpec};
use crate::world::World;

/// A spec is not generated again if it asks for more parts than this...
const MOST_WORK: f64 = 1e6;

/// ...plus this many times the number of parts that the world has.
const MOST_WORK_A_PART: f64 = 1e3;

/// The greatest number of manual changes that are repeated.
const MOST_EDITS: usize = 10_000;

/// The result of comparing a world with the one that its provenance gives.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum Reproduction {
    /// The spec and seed, with the manual changes of a plan, give this world to the last bit, from this blueprint.
    Same(Box<WorldBlueprint>),
    /// The spec and seed give another world.
    Different,
    /// The spec and seed give this world, but with another certificate.
    OtherCertificate,
    /// The spec and seed give no world; the text is the reason.
    NoWorld(String),
    /// To generate the spec takes so much work for a world of this size that it was not compared.
    TooLarge {
        /// The work: see [`Spec::work`](crate::Spec::work).
        work: f64,
        /// Number of parts that the world holds.
        parts: u64,
    },
    /// The world was made by another algorithm of random streams and was not compared.
    OtherAlgorithm(String),
    /// The world has another value version and was not compared.
    OtherVersion {
        /// The value version of the world.
        made_by: u32,
        /// The value version of this crate.
        makes: u32,
    },
    /// The world is marked as edited without a list of its edits, and was not compared.
    Edited,
    /// The world has no spec and seed, because it was imported or built by hand.
    NoSpec,
}

impl Reproduction {
    /// Returns whether the result does not contradict the world's provenance.
    pub fn is_credible(&self) -> bool {
        match self {
            Reproduction::Same(_)
            | Reproduction::TooLarge { .. }
            | Reproduction::OtherAlgorithm(_)
            | Reproduction::OtherVersion { .. }
            | Reproduction::Edited
            | Reproduction::NoSpec => true,
            Reproduction::Different | Reproduction::OtherCertificate | Reproduction::NoWorld(_) => {
                false
            }
        }
    }
}

impl fmt::Display for Reproduction {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Reproduction::Same(blueprint) => {
                let edits = match &**blueprint {
                    WorldBlueprint::Indoor(plan) if plan.is_edited() => ", with its edits,",
                    _ => "",
                };
                write!(f, "reproducible: its spec and seed{edits} make this world to the last bit")
            }
            Reproduction::Different => {
                f.write_str("not reproducible: its spec and seed make another world")
            }
            Reproduction::OtherCertificate => f.write_str(
                "not reproducible: its spec and seed make this world, with another certificate",
            ),
            Reproduction::NoWorld(reason) => {
                write!(f, "not reproducible: its spec and seed make no world: {reason}")
            }
            Reproduction::TooLarge { work, parts } => write!(
                f,
                "not compared: to generate its spec is as much work as about {work:.0} parts, the world \
                 holds {parts}"
            ),
            Reproduction::OtherAlgorithm(algorithm) => write!(
                f,
                "not compared: made by the random streams {algorithm:?}, this program has {STREAM_ALGORITHM:?}"
            ),
            Reproduction::OtherVersion { made_by, makes } => write!(
                f,
                "not compared: made by value version {made_by}, this program makes {makes}"
            ),
            Reproduction::Edited => {
                f.write_str("not compared: it says that it was edited after it was generated")
            }
            Reproduction::NoSpec => f.write_str(
                "not compared: it has no spec and seed, because it was imported or made by hand",
            ),
        }
    }
}

/// Generates a world again from the spec and the seed in its provenance, and compares the two.
///
/// The [digests](World::digest) are compared, and the certificates: that of an edited plan may lack claims. Whatever
/// the provenance claims, the cost is bounded by a fixed amount plus a fixed multiple of the world's size.
///
/// ```
/// use envgen::reproduction::{Reproduction, reproduce};
/// use envgen::{Blueprint, Seed, Spec, hallway::HallwaySpec};
///
/// let mut world = HallwaySpec::default().generate(Seed(7))?.to_world();
/// assert!(matches!(reproduce(&world), Reproduction::Same(_)));
/// // A world that was changed and does not say so.
/// world.walls.pop();
/// assert_eq!(reproduce(&world), Reproduction::Different);
/// assert!(!reproduce(&world).is_credible());
/// # Ok::<(), envgen::GenerateError>(())
/// ```
pub fn reproduce(world: &World) -> Reproduction {
    let provenance = &world.provenance;
    let (Ok(kind), Some(seed)) = (provenance.kind.parse::<WorldKind>(), provenance.seed) else {
        return Reproduction::NoSpec;
    };
    if provenance.edited && provenance.edits.is_empty() {
        return Reproduction::Edited;
    }
    if provenance.value_version != kind.value_version() {
        let (made_by, makes) = (provenance.value_version, kind.value_version());
        return Reproduction::OtherVersion { made_by, makes };
    }
    if provenance.algorithm != STREAM_ALGORITHM {
        return Reproduction::OtherAlgorithm(provenance.algorithm.clone());
    }
    let spec = match spec(provenance) {
        Ok(spec) => spec,
        Err(reason) => return Reproduction::NoWorld(reason),
    };
    let (work, parts) = (spec.work(), world.part_count() as u64);
    if !may_have_size(world, &spec) {
        return Reproduction::Different;
    }
    if work > MOST_WORK + MOST_WORK_A_PART * parts as f64 {
        return Reproduction::TooLarge { work, parts };
    }
    match spec.generate(seed) {
        Err(error) => Reproduction::NoWorld(error.to_string()),
        Ok(blueprint) => match edited(blueprint, &provenance.edits) {
            Err(reason) => Reproduction::NoWorld(reason),
            Ok(blueprint) => compare(world, blueprint),
        },
    }
}

fn compare(world: &World, blueprint: WorldBlueprint) -> Reproduction {
    let generated = blueprint.to_world();
    if generated.digest() != world.digest() {
        return Reproduction::Different;
    }
    let is_same = if world.provenance.edited {
        // Of an edited world only what is still kept is promised.
        world.certificate.iter().all(|claim| generated.certificate.contains(claim))
    } else {
        generated.certificate == world.certificate
    };
    if !is_same {
        return Reproduction::OtherCertificate;
    }
    Reproduction::Same(Box::new(blueprint))
}

/// Returns a plan with the manual changes of a [`Provenance`]; a plan without changes is returned unchanged.
///
/// # Errors
/// When a plan of another kind than indoor maps has edits, when there are too many, or when one cannot be made.
pub fn edited(blueprint: WorldBlueprint, edits: &[Value]) -> Result<WorldBlueprint, String> {
    let plan = match blueprint {
        _ if edits.is_empty() => return Ok(blueprint),
        WorldBlueprint::Indoor(plan) => plan,
        _ => return Err("only indoor maps have edits".to_owned()),
    };
    if edits.len() > MOST_EDITS {
        return Err(format!("there are {} edits, at most {MOST_EDITS} are made", edits.len()));
    }
    let mut editor = PlanEditor::new(plan);
    for (i, edit) in edits.iter().enumerate() {
        let edit = Edit::deserialize(edit).map_err(|error| format!("edit {i}: {error}"))?;
        editor.apply(edit).map_err(|error| format!("edit {i}: {error}"))?;
    }
    Ok(WorldBlueprint::Indoor(editor.into_plan()))
}

fn spec(provenance: &Provenance) -> Result<WorldSpec, String> {
    let spec = WorldSpec::from_provenance(provenance).map_err(|error| error.to_string())?;
    spec.validate().map_err(|error| error.to_string())?;
    Ok(spec)
}

/// Whether a world may have the size that a spec asks for, so far as the spec alone tells.
fn may_have_size(world: &World, spec: &WorldSpec) -> bool {
    match spec {
        WorldSpec::Landscape(spec) => world.raster.as_ref().is_some_and(|raster| {
            u64::from(raster.rows) == spec.rows && u64::from(raster.cols) == spec.cols
        }),
        WorldSpec::Forest(spec) => {
            let (area, bounds) = (spec.area(), world.bounds);
            let most = area.grown(spec.largest_radius());
            most.contains(bounds.min)
                && most.contains(bounds.max)
                && bounds.max.cmpge(area.max).all()
        }
        _ => true,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cellular::{CellularSpec, OpenSides};
    use crate::generate::{Blueprint, Spec};
    use crate::indoor::{Catalogue, IndoorSpec};
    use crate::landscape::LandscapeSpec;
    use crate::seed::Seed;
    use crate::world::Claim;
    use serde_json::json;

    fn forest() -> World {
        WorldKind::Forest.default_spec().generate(Seed(3)).unwrap().to_world()
    }

    #[test]
    fn every_kind_is_made_again() {
        for &kind in WorldKind::ALL {
            let blueprint = kind.default_spec().generate(Seed(3)).unwrap();
            let found = reproduce(&blueprint.to_world());
            assert_eq!(found, Reproduction::Same(Box::new(blueprint)), "{kind}");
            assert!(found.is_credible());
        }
    }

    /// A small map with a room less, a hallway and a room more, and an object turned.
    fn edited_map() -> World {
        let spec = IndoorSpec { width: 8, height: 8, ..Default::default() };
        let plan = spec.generate(Seed(2)).unwrap();
        let mut editor = PlanEditor::new(plan);
        editor.apply(Edit::RemoveRoom { room: 0 }).unwrap();
        let open = (0..64)
            .map(|i| (i % 8, i / 8))
            .find(|&(x, y)| editor.test(Edit::AddHallway { x, y }).is_ok());
        let (x, y) = open.unwrap();
        editor.apply(Edit::AddHallway { x, y }).unwrap();
        let room = Catalogue::builtin().rooms()[0].clone();
        let free = (0..64).find_map(|i| {
            let add = Edit::AddRoom { room: room.clone(), x: i % 8, y: i / 8, quarters: 1 };
            editor.test(add.clone()).is_ok().then_some(add)
        });
        editor.apply(free.unwrap()).unwrap();
        let turn = (0..editor.plan().rooms().len())
            .map(|room| Edit::TurnObject { room, object: 0, angle: 0.1 })
            .find(|turn| editor.test(turn.clone()).is_ok());
        editor.apply(turn.unwrap()).unwrap();
        editor.into_plan().to_world()
    }

    #[test]
    fn a_plan_is_edited_again() {
        let world = edited_map();
        assert_eq!(world.provenance.edits.len(), 4);
        let (mut json, mut ron) = (Vec::new(), Vec::new());
        world.write_json(&mut json).unwrap();
        world.write_ron(&mut ron).unwrap();
        let from_json = crate::import::read_json(&mut json.as_slice()).unwrap();
        let from_ron = crate::import::read_ron(&mut ron.as_slice()).unwrap();
        for world in [&world, &from_json, &from_ron] {
            let found = reproduce(world);
            assert!(found.to_string().contains("with its edits"), "{found}");
            let Reproduction::Same(blueprint) = found else { panic!("{found}") };
            assert_eq!(blueprint.to_world(), *world);
        }
        let mut claims = world.clone();
        claims.certificate.push(Claim::AddedDoorway { doorway: 999 });
        assert_eq!(reproduce(&claims), Reproduction::OtherCertificate);
        claims.certificate.truncate(1);
        assert!(matches!(reproduce(&claims), Reproduction::Same(_)));
        let mut fewer = world.clone();
        fewer.provenance.edits.pop();
        assert_eq!(reproduce(&fewer), Reproduction::Different);
        fewer.provenance.edits.clear();
        assert_eq!(reproduce(&fewer), Reproduction::Edited);
    }

    #[test]
    fn edits_that_cannot_be_made_are_named() {
        let known = edited_map();
        for (edit, why) in [
            (json!({"remove_room": {"room": 999}}), "edit 4: there is no room 999"),
            (json!({"paint": {}}), "edit 4: unknown variant `paint`"),
            (json!({"add_hallway": {"x": 1, "y": 2, "z": 3}}), "edit 4: unknown field `z`"),
            (json!(7), "edit 4: "),
        ] {
            let mut world = known.clone();
            world.provenance.edits.push(edit);
            let found = reproduce(&world);
            let Reproduction::NoWorld(reason) = &found else { panic!("{found}") };
            assert!(reason.contains(why), "{reason}");
        }
        let mut world = known;
        world.provenance.edits = vec![json!(null); MOST_EDITS + 1];
        assert!(reproduce(&world).to_string().contains("10001 edits, at most 10000"));
        let mut other = forest();
        other.provenance.edited = true;
        other.provenance.edits = vec![json!({"add_hallway": {"x": 1, "y": 2}})];
        assert!(reproduce(&other).to_string().contains("only indoor maps have edits"));
    }

    /// The places of the numbers in a value.
    fn numbers(value: &Value, at: String, found: &mut Vec<String>) {
        match value {
            Value::Number(_) => found.push(at),
            Value::Array(list) => {
                list.iter().enumerate().for_each(|(i, v)| numbers(v, format!("{at}/{i}"), found));
            }
            Value::Object(map) => {
                map.iter().for_each(|(key, v)| numbers(v, format!("{at}/{key}"), found));
            }
            _ => {}
        }
    }

    #[test]
    fn edits_of_broken_files_are_refused() {
        let mut world = edited_map();
        let known = world.provenance.edits.clone();
        let object = json!(world.obstacles[0]);
        let others = [
            json!({"move_room": {"room": 0, "x": 0, "y": 0}}),
            json!({"turn_room": {"room": 0, "quarters": 1}}),
            json!({"add_object": {"room": 0, "object": object}}),
            json!({"move_object": {"room": 0, "object": 0, "by": [0.1, 0.0]}}),
            json!({"remove_object": {"room": 0, "object": 0}}),
        ];
        let with = |other: &Value| known.iter().chain([other]).cloned().collect::<Vec<_>>();
        let lists = others.iter().map(with).chain([known.clone()]);
        let broken =
            [json!(-1), json!(255), json!(u32::MAX), json!(u64::MAX), json!(1e300), json!(-1e9)];
        let (mut tried, mut refused) = (0, 0);
        for edits in lists.map(Value::Array) {
            let mut places = Vec::new();
            numbers(&edits, String::new(), &mut places);
            for (place, value) in places.iter().flat_map(|p| broken.iter().map(move |v| (p, v))) {
                let mut edits = edits.clone();
                *edits.pointer_mut(place).unwrap() = value.clone();
                world.provenance.edits = edits.as_array().unwrap().clone();
                let found = reproduce(&world);
                tried += 1;
                refused += usize::from(matches!(
                    found,
                    Reproduction::NoWorld(_) | Reproduction::Different
                ));
            }
        }
        // A room may look the same after other turns.
        assert!(tried > 200 && 10 * refused > 9 * tried, "{refused} of {tried}");
    }

    #[test]
    fn what_was_changed_is_found() {
        let mut moved = forest();
        moved.trees[7].center.x += 0.5;
        let mut reseeded = forest();
        reseeded.provenance.seed = Some(Seed(4));
        for world in [moved, reseeded] {
            assert_eq!(reproduce(&world), Reproduction::Different);
            assert!(!reproduce(&world).is_credible());
        }
        let mut world = forest();
        world.provenance.spec["intensity"] = json!(-1);
        let found = reproduce(&world);
        assert!(
            matches!(&found, Reproduction::NoWorld(why) if why.contains("`intensity` must be"))
        );
        assert!(!found.is_credible());
        world.provenance.spec["intensity"] = json!("dense");
        assert!(matches!(reproduce(&world), Reproduction::NoWorld(_)));
    }

    #[test]
    fn what_says_so_is_not_compared() {
        let mut world = forest();
        world.provenance.value_version += 1;
        assert_eq!(reproduce(&world), Reproduction::OtherVersion { made_by: 2, makes: 1 });
        let mut other = forest();
        other.provenance.algorithm = "dice".to_owned();
        let found = reproduce(&other);
        assert!(found.is_credible() && found.to_string().contains("streams \"dice\""), "{found}");
        world.provenance.edited = true;
        assert_eq!(reproduce(&world), Reproduction::Edited);
        world.provenance.seed = None;
        assert_eq!(reproduce(&world), Reproduction::NoSpec);
        assert!(reproduce(&world).is_credible());
    }

    #[test]
    fn specs_of_much_more_than_the_world_are_not_tried() {
        let mut world = forest();
        world.provenance.spec["width"] = json!(1e6);
        assert_eq!(reproduce(&world), Reproduction::Different);
        // Worlds may be honest and hold little of what their specs draw.
        let (rows, cols, open_sides) = (1024, 1024, OpenSides::All);
        let empty =
            CellularSpec { rows, cols, fill: 0.0, open_sides, attempts: 10, ..Default::default() };
        let found = reproduce(&empty.generate(Seed(1)).unwrap().to_world());
        assert!(matches!(found, Reproduction::TooLarge { .. }), "{found}");
        assert!(found.is_credible());
        let landscape = LandscapeSpec::default();
        let mut world = landscape.generate(Seed(1)).unwrap().to_world();
        world.provenance.spec["rows"] = json!(4096);
        assert_eq!(reproduce(&world), Reproduction::Different);
    }

    #[test]
    fn a_certificate_that_was_changed_is_found() {
        let world = forest();
        assert!(!world.certificate.is_empty());
        let mut stripped = world.clone();
        stripped.certificate.clear();
        assert_eq!(reproduce(&stripped), Reproduction::OtherCertificate);
        assert!(!reproduce(&stripped).is_credible());
        let mut fewer = world.clone();
        fewer.certificate.pop();
        assert_eq!(reproduce(&fewer), Reproduction::OtherCertificate);
        assert!(matches!(reproduce(&world), Reproduction::Same(_)));
    }
}
