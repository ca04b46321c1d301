//! The scores as rows of a table, for terminals and panels.

use super::scores::Scores;

/// One row of the table of scores.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ScoreRow {
    /// The row's name, such as `wall F1`.
    pub name: &'static str,
    /// The value with its unit.
    pub value: String,
    /// What the value means.
    pub meaning: &'static str,
}

impl Scores {
    /// Returns D, M and N, and their parts, the most important first.
    pub fn rows(&self) -> Vec<ScoreRow> {
        let percent = |share: f64| format!("{:.1} %", 100.0 * share);
        let metres = |distance: f64| format!("{distance:.2} m");
        let some = |distance: Option<f64>| distance.map_or("-".to_owned(), metres);
        let number = |score: f64| format!("{score:.2}");
        let rows = [
            ("D  difficulty", number(self.difficulty), "0.6 M + 0.4 N, from 0 to 10"),
            ("M  of mapping", number(self.mapping), "walls, use, pose, coverage"),
            ("N  of navigation", number(self.navigation), "time, coverage, collisions, turning"),
            (
                "D, M, N by score 1",
                [self.score_1.difficulty, self.score_1.mapping, self.score_1.navigation]
                    .map(number)
                    .join("  "),
                "not by area and distance",
            ),
            ("coverage", percent(self.coverage), "of the reachable ground shown as free"),
            ("wall precision", percent(self.precision_30), "within 0.30 m"),
            ("wall recall", percent(self.recall_30), "within 0.30 m"),
            ("wall F1", percent(self.f1_30), "within 0.30 m"),
            ("wall F1, strict", percent(self.f1_15), "within 0.15 m"),
            ("wall distance", metres(self.wall_distance), "mean, in both directions, cut at 1 m"),
            ("ghosting", percent(self.ghosting), "of the walls mapped twice"),
            ("navigability", percent(self.navigability), "of 40 paths planned on the map arrive"),
            ("trajectory error", metres(self.trajectory_error), "RMSE, not aligned"),
            ("relative error", some(self.relative_error_near), "over 1 m"),
            ("relative error, far", some(self.relative_error_far), "over 20 m"),
        ];
        let moving = self.moving.iter().flat_map(|moving| {
            let area = |area: f64| format!("{area:.1} m^2");
            [
                (
                    "collisions with people",
                    moving.person_collisions.to_string(),
                    "not among the others",
                ),
                ("swept area", area(moving.swept_area), "by people and doors, not scored"),
                ("ghosts", area(moving.ghost_area), "of it shown as occupied, off the walls"),
            ]
        });
        let rows = rows.into_iter().chain(moving);
        rows.map(|(name, value, meaning)| ScoreRow { name, value, meaning }).collect()
    }
}
