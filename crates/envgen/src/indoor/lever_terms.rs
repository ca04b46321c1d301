//! Terms of the settings from which linear models predict the difficulty of a map.

use super::adaptation;
use super::spec::{Cycles, IndoorSpec, Layout, RoomChoice};

/// The number of passages per metre above which mazes count as narrow.
const WIDE: f64 = 0.7;

impl IndoorSpec {
    /// Returns numbers that follow from the settings alone, none of them negative, from which the difficulty is
    /// predicted before a map is generated: sizes, the expected results of the rules of difficulty, and the amount
    /// of each material.
    pub fn lever_terms(&self) -> Vec<(&'static str, f64)> {
        let cell = self.cell_size;
        let (width, height) = (f64::from(self.width), f64::from(self.height));
        let spacing = |given: Option<u32>, size: u32| {
            let drawn = || adaptation::spacing_mean(self.difficulty, size).max(3.0);
            cell * given.map_or_else(drawn, f64::from)
        };
        let doorways = || adaptation::doorway_probability(self.difficulty);
        let no_cycles = match self.cycles {
            Cycles::Difficulty => adaptation::cycle_prevention_probability(self.difficulty),
            Cycles::Allow => 0.0,
            Cycles::Prevent => 1.0,
        };
        let grown = f64::from(u8::from(self.layout == Layout::LSystem));
        let narrowest = self.doorway_narrowest.unwrap_or(self.doorway);
        let slip = (self.floor_slip - 1.0) * self.floor_slip_share;
        let bias = 10.0 * self.wheel_bias * self.wheel_bias_share;
        // Per metre: how near a robot must be.
        let dark = 10.0 / self.dark_range;
        let (walls, objects) = (self.dark_walls * dark, self.dark_objects * dark);
        let rooms = self.allowed_rooms();
        let probabilities = self.room_probabilities();
        let expected = |of: &dyn Fn(usize) -> f64| {
            (0..rooms.len()).map(|i| probabilities[i] * of(i)).sum::<f64>()
        };
        let cells = |i: usize| f64::from(rooms[i].width * rooms[i].height);
        vec![
            ("area_m2", width * height * cell * cell),
            ("cell_size_m", cell),
            ("elongation", width.max(height) / width.min(height)),
            ("wall_thickness_m", self.wall_thickness),
            ("spacing_h_m", spacing(self.spacing_h, self.width)),
            ("spacing_v_m", spacing(self.spacing_v, self.height)),
            ("no_cycles", no_cycles),
            ("l_system", grown),
            ("branching", grown * self.branching),
            ("uniform_rooms", f64::from(u8::from(self.room_choice == RoomChoice::Uniform))),
            ("room_difficulty", expected(&|i| rooms[i].difficulty)),
            ("room_cells", expected(&cells)),
            ("room_objects_per_cell", expected(&|i| rooms[i].obstacles.len() as f64 / cells(i))),
            ("room_walls_per_cell", expected(&|i| rooms[i].walls.len() as f64 / cells(i))),
            ("doorway_probability", self.doorway_probability.unwrap_or_else(doorways)),
            ("doorway_m", 0.5 * (self.doorway + narrowest)),
            ("doorway_narrowest_m", narrowest),
            ("clutter_per_100_m2", self.clutter),
            ("mazes", self.mazes),
            ("narrow_mazes", self.mazes * (1.0 / self.maze_passage - WIDE).max(0.0)),
            ("maze_loops", self.mazes * self.maze_braid),
            ("slip", slip),
            ("bias", bias),
            ("dark_walls_per_range", walls),
            ("dark_objects_per_range", objects),
            ("dark_and_slip", walls * slip),
            ("dark_and_bias", walls * bias),
            ("slip_and_bias", slip * bias),
            ("dark_walls_and_objects", walls * objects),
            ("slip_and_clutter", slip * self.clutter),
            ("dark_and_clutter", walls * self.clutter),
        ]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::seed::Seed;

    #[test]
    fn terms_are_numbers_that_levers_move() {
        let base = IndoorSpec::default();
        let plain = base.lever_terms();
        let drawn: Vec<_> =
            (0..60).map(|seed| base.draw_levers(Seed(seed)).lever_terms()).collect();
        for terms in &drawn {
            assert!(terms.iter().all(|(_, value)| value.is_finite() && *value >= 0.0), "{terms:?}");
        }
        let size = ["area_m2", "cell_size_m", "elongation", "wall_thickness_m"];
        for (i, (name, _)) in plain.iter().enumerate() {
            let moves = drawn.iter().any(|terms| terms[i] != drawn[0][i]);
            assert_ne!(moves, size.contains(name), "{name}");
        }
        let names: std::collections::BTreeSet<_> = plain.iter().map(|(name, _)| name).collect();
        assert_eq!(names.len(), plain.len());
    }
}
