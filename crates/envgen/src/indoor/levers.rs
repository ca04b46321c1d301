//! Random draws of the settings that make a map easy or difficult, for maps of a given size.
//!
//! Doorways, rooms, mazes and clutter loosely follow a common severity. Floors and walls are drawn independently of
//! each other, so that no material alone makes maps difficult. Every lever has its own random stream, so that
//! keeping a lever does not change any other lever. No lever exceeds what occurs in buildings: floors slip at most
//! as on rubble, and dark walls are visible from 2 m.

use std::collections::BTreeSet;
use std::f64::consts::PI;

use super::dimensions::STEP;
use super::spec::{Cycles, IndoorSpec, LEVERS, Layout, MOST_DOORWAY, Profile, RoomChoice};
use crate::seed::{Seed, Stream};

/// The greatest factor on the variances of wheel odometry that is drawn.
const MOST_SLIP: f64 = 25.0;

/// The greatest wheel bias that is drawn.
const MOST_BIAS: f64 = 0.18;

/// Visible range in metres of dark walls where the lever begins, and where it ends.
const DARK_RANGES: [f64; 2] = [8.0, 2.0];

/// The least share of the floors or walls that a material covers if it is drawn.
const LEAST_SHARE: f64 = 0.3;

/// The greatest number of crates per 100 m^2 that is drawn.
const MOST_CLUTTER: f64 = 25.0;

/// The widest passage of mazes in metres that is drawn.
const WIDEST_PASSAGE: f64 = 3.0;

/// The narrowest doorway in metres that a setting allows.
const LEAST_DOORWAY: f64 = 0.2;

/// The greatest difference in metres between the widest and the narrowest doorways that are drawn.
const WIDER: f64 = 2.0;

/// Probability of each material. Materials are drawn independently, so that no material alone makes maps difficult.
const MATERIAL: f64 = 0.55;

/// Number of rooms from which a few are chosen.
const THEME: usize = 8;

/// The greatest distance between hallways in cells that is drawn.
const FARTHEST: u32 = 10;

/// The levers of a spec, and those that keep their values.
pub(super) struct Levers<'a> {
    base: &'a IndoorSpec,
    kept: BTreeSet<&'static str>,
}

impl<'a> Levers<'a> {
    /// Keeps the levers that the spec sets to other values than the defaults, and those that it fixes.
    pub(super) fn new(base: &'a IndoorSpec) -> Self {
        let (own, defaults) = (base.settings_json(), IndoorSpec::default().settings_json());
        let is_kept = |name: &&str| {
            // The difficulty is what the map should have, as measured, not the rules' number.
            *name != "difficulty"
                && (own[*name] != defaults[*name] || base.fixed.iter().any(|fixed| fixed == name))
        };
        let kept = LEVERS.into_iter().filter(is_kept).collect();
        Levers { base, kept }
    }

    /// Returns the spec with its levers drawn.
    pub(super) fn draw(&self, seed: Seed) -> IndoorSpec {
        let base = self.base;
        let mut draws = stream("severity", seed);
        let navigation = severity(&mut draws);
        let mut spec = IndoorSpec {
            profile: Profile::Guaranteed,
            mapping: None,
            navigation: None,
            fixed: Vec::new(),
            candidate: 0,
            ..base.clone()
        };
        self.lever("difficulty", seed, |stream| {
            spec.difficulty = 10.0 * near(navigation, 0.3, stream);
        });
        self.plan(&mut spec, navigation, seed);
        self.doorways(&mut spec, navigation, seed);
        self.mazes(&mut spec, navigation, seed);
        self.lever("clutter", seed, |stream| {
            spec.clutter = MOST_CLUTTER * strength(navigation, stream);
        });
        self.materials(&mut spec, seed);
        if spec.check().is_err() {
            // Rooms of the caller may all be too large.
            spec.rooms.clone_from(&base.rooms);
        }
        spec
    }

    /// Calls `set` with the lever's own stream, unless the lever is kept.
    fn lever(&self, name: &'static str, seed: Seed, set: impl FnOnce(&mut Stream)) {
        if !self.kept.contains(name) {
            set(&mut stream(name, seed));
        }
    }

    /// Draws hallways and rooms.
    fn plan(&self, spec: &mut IndoorSpec, navigation: f64, seed: Seed) {
        self.lever("layout", seed, |stream| {
            spec.layout = if stream.chance(0.25) { Layout::LSystem } else { Layout::Grid };
        });
        self.lever("branching", seed, |stream| spec.branching = stream.unit());
        self.lever("cycles", seed, |stream| {
            let all = [Cycles::Difficulty, Cycles::Allow, Cycles::Prevent];
            spec.cycles = all[stream.below(all.len() as u64) as usize];
        });
        let spacing = |size: u32, stream: &mut Stream| {
            let farthest = FARTHEST.min(size - 1);
            let cells = 3 + stream.below(u64::from(farthest - 2)) as u32;
            stream.chance(0.5).then_some(cells)
        };
        self.lever("spacing_h", seed, |stream| spec.spacing_h = spacing(spec.width, stream));
        self.lever("spacing_v", seed, |stream| spec.spacing_v = spacing(spec.height, stream));
        self.lever("doorway_probability", seed, |stream| {
            let probability = stream.between(0.1, 1.0);
            spec.doorway_probability = stream.chance(0.5).then_some(probability);
        });
        self.lever("room_choice", seed, |stream| {
            let uniform = stream.chance(0.4);
            spec.room_choice = if uniform { RoomChoice::Uniform } else { RoomChoice::Difficulty };
        });
        self.lever("rooms", seed, |stream| {
            if stream.chance(0.6) {
                spec.rooms = theme(self.base, near(navigation, 0.2, stream), stream);
            }
        });
    }

    /// Draws the widths of doorways, in whole centimetres. If no choice of widths is possible, they are kept.
    fn doorways(&self, spec: &mut IndoorSpec, navigation: f64, seed: Seed) {
        let least = (2.0 * (spec.robot_radius + STEP)).max(LEAST_DOORWAY);
        // Those that are to be kept stay the narrowest.
        let kept = self.base.doorway_narrowest.filter(|_| self.kept.contains("doorway_narrowest"));
        let least = kept.map_or(least, |narrowest| narrowest.max(least));
        let between_walls = centimetres(spec.cell_size - 2.0 * spec.wall_thickness, f64::floor);
        let widest = between_walls.min(least + WIDER).min(MOST_DOORWAY);
        let least = centimetres(least, f64::ceil);
        self.lever("doorway", seed, |stream| {
            let width = widest - (widest - least) * near(navigation, 0.2, stream);
            if least < widest {
                spec.doorway = centimetres(width, f64::round).clamp(least, widest);
            }
        });
        self.lever("doorway_narrowest", seed, |stream| {
            let (share, is_drawn) = (stream.unit(), stream.chance(0.3));
            let width = centimetres(least + (spec.doorway - least) * share, f64::round);
            let is_possible = is_drawn && least < spec.doorway;
            spec.doorway_narrowest = is_possible.then(|| width.clamp(least, spec.doorway));
        });
    }

    /// Draws mazes. One passage must fit into a cell.
    fn mazes(&self, spec: &mut IndoorSpec, navigation: f64, seed: Seed) {
        let widest = 0.5 * spec.cell_size - spec.wall_thickness;
        let least = centimetres(2.0 * (spec.robot_radius + STEP), f64::ceil);
        self.lever("maze_passage", seed, |stream| {
            let width = widest - (widest - least) * near(navigation, 0.3, stream);
            spec.maze_passage = centimetres(width.min(WIDEST_PASSAGE), f64::floor).max(least);
        });
        self.lever("maze_braid", seed, |stream| spec.maze_braid = stream.unit());
        self.lever("mazes", seed, |stream| {
            let share = strength(navigation, stream);
            spec.mazes = if spec.maze_passage >= least { share } else { 0.0 };
        });
    }

    /// Draws slippery and loose floors, and dark walls and objects.
    fn materials(&self, spec: &mut IndoorSpec, seed: Seed) {
        self.lever("floor_slip", seed, |stream| {
            spec.floor_slip = 1.0 + (MOST_SLIP - 1.0) * amount(stream);
        });
        self.lever("floor_slip_share", seed, |stream| {
            spec.floor_slip_share = stream.between(LEAST_SHARE, 1.0);
        });
        self.lever("wheel_bias", seed, |stream| {
            spec.wheel_bias = MOST_BIAS * amount(stream);
        });
        self.lever("wheel_bias_share", seed, |stream| {
            spec.wheel_bias_share = stream.between(LEAST_SHARE, 1.0);
        });
        // Walls and objects are dark together.
        let dark = amount(&mut stream("dark", seed));
        self.lever("dark_range", seed, |_| {
            let [from, to] = DARK_RANGES.map(f64::recip);
            spec.dark_range = 1.0 / (from + (to - from) * dark);
        });
        self.lever("dark_walls", seed, |stream| {
            let share = stream.between(LEAST_SHARE, 1.0);
            spec.dark_walls = if dark > 0.0 { share } else { 0.0 };
        });
        self.lever("dark_objects", seed, |stream| {
            spec.dark_objects = if dark > 0.0 { stream.unit() } else { 0.0 };
        });
    }
}

impl IndoorSpec {
    /// Draws the settings that make a map easy or difficult, within what occurs in buildings: doorways, hallways,
    /// rooms, clutter, floors and materials. Settings with other values than the defaults, and those in `fixed`,
    /// keep their values; size, robot and walls are never drawn. The result has the profile `guaranteed`.
    ///
    /// ```
    /// use envgen::Seed;
    /// use envgen::indoor::IndoorSpec;
    ///
    /// let dry = IndoorSpec { fixed: vec!["floor_slip".into()], ..Default::default() };
    /// let spec = dry.draw_levers(Seed(3));
    /// assert_eq!((spec.width, spec.floor_slip), (16, 1.0));
    /// assert_ne!(spec.difficulty, dry.draw_levers(Seed(4)).difficulty);
    /// ```
    pub fn draw_levers(&self, seed: Seed) -> IndoorSpec {
        Levers::new(self).draw(seed)
    }
}

/// Returns the stream of a lever.
fn stream(lever: &str, seed: Seed) -> Stream {
    seed.stream(&format!("indoor/levers/{lever}"), 0)
}

/// Draws the intended severity of one aspect of a map, from 0 to 1. Easy and difficult maps are more frequent than
/// those between, of which mixtures of levers give enough.
fn severity(stream: &mut Stream) -> f64 {
    0.5 - 0.5 * libm::cos(PI * stream.unit())
}

/// Draws a number from 0 to 1 that is near another number.
fn near(severity: f64, spread: f64, stream: &mut Stream) -> f64 {
    (severity + stream.between(-spread, spread)).clamp(0.0, 1.0)
}

/// Draws the strength of a lever, from 0 to 1. It is 0 for some maps of any severity.
fn strength(severity: f64, stream: &mut Stream) -> f64 {
    let (is_on, share) = (stream.chance(0.3 + 0.5 * severity), stream.between(0.5, 1.0));
    if is_on { severity * share } else { 0.0 }
}

/// Draws the amount of a material, from 0 to 1.
fn amount(stream: &mut Stream) -> f64 {
    let (is_there, amount) = (stream.chance(MATERIAL), stream.unit());
    if is_there { amount } else { 0.0 }
}

/// Draws a few of the rooms that may be placed, of about the same difficulty.
fn theme(base: &IndoorSpec, severity: f64, stream: &mut Stream) -> Vec<String> {
    let mut rooms = base.allowed_rooms();
    rooms.sort_by(|a, b| a.difficulty.total_cmp(&b.difficulty));
    let window = THEME.min(rooms.len());
    let first = (severity * (rooms.len() - window) as f64).round() as usize;
    let mut names: Vec<String> =
        rooms[first..first + window].iter().map(|room| room.name.clone()).collect();
    let wanted = 1 + stream.below(5) as usize;
    while names.len() > wanted {
        let last = names.len() as u64;
        names.swap_remove(stream.below(last) as usize);
    }
    names
}

/// Rounds a length to whole centimetres.
fn centimetres(metres: f64, round: fn(f64) -> f64) -> f64 {
    round(metres * 100.0) / 100.0
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::indoor::Turn;
    use crate::{Blueprint, Spec};

    #[test]
    fn every_lever_is_a_setting_and_moves() {
        let base = IndoorSpec::default();
        let drawn: Vec<_> =
            (0..40).map(|seed| base.draw_levers(Seed(seed)).settings_json()).collect();
        for lever in LEVERS {
            assert!(IndoorSpec::SETTINGS.iter().any(|setting| setting.name == lever), "{lever}");
            assert!(drawn.iter().any(|spec| spec[lever] != drawn[0][lever]), "{lever}");
        }
        for setting in IndoorSpec::SETTINGS.iter().filter(|s| !LEVERS.contains(&s.name)) {
            let first = &drawn[0][setting.name];
            assert!(drawn.iter().all(|spec| spec[setting.name] == *first), "{}", setting.name);
        }
    }

    #[test]
    fn a_kept_lever_moves_no_other() {
        let base = IndoorSpec { profile: Profile::Calibrated, ..Default::default() };
        for lever in LEVERS.into_iter().filter(|lever| *lever != "difficulty") {
            let fixed = IndoorSpec { fixed: vec![lever.to_owned()], ..base.clone() };
            for seed in 0..20 {
                let mut free = base.draw_levers(Seed(seed)).settings_json();
                let kept = fixed.draw_levers(Seed(seed)).settings_json();
                assert_eq!(kept[lever], base.settings_json()[lever]);
                free[lever] = kept[lever].clone();
                // The narrowest doorway is drawn up to the width of the widest.
                if lever == "doorway" {
                    free["doorway_narrowest"] = kept["doorway_narrowest"].clone();
                }
                assert_eq!(free, kept, "{lever}");
            }
        }
        let set = IndoorSpec { wheel_bias: 0.3, turn: Turn::Never, ..base };
        assert_eq!(set.draw_levers(Seed(1)).wheel_bias, 0.3);
    }

    #[test]
    fn every_draw_can_be_generated() {
        for seed in 0..60 {
            let size = 4 + (seed % 9) as u32;
            let base = IndoorSpec { width: size, height: 12 - size / 2, ..Default::default() };
            let spec = base.draw_levers(Seed(seed));
            let plan = spec.generate(Seed(seed)).expect("a plan");
            assert_eq!(plan.to_world().check(), Ok(()));
        }
    }

    proptest! {
        #[test]
        fn every_draw_is_allowed(
            seed in any::<u64>(),
            (width, height) in (4..40_u32, 4..40_u32),
            cell_size in 1.6..12.0_f64,
            wall_thickness in 0.01..0.3_f64,
            robot_radius in 0.01..0.4_f64,
        ) {
            let base = IndoorSpec {
                width, height, cell_size, wall_thickness, robot_radius, ..Default::default()
            };
            prop_assume!(base.validate().is_ok());
            let spec = base.draw_levers(Seed(seed));
            prop_assert_eq!(spec.validate(), Ok(()));
            prop_assert_eq!(spec.profile, Profile::Guaranteed);
        }
    }
}
