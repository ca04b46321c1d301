//! Designs: the trials of which an experiment consists.

use std::fmt;
use std::str::FromStr;

use envgen::indoor::{IndoorSpec, Profile};
use envgen::settings::Setting;
use envgen::{Seed, Spec, SpecError, settings};
use serde::{Deserialize, Serialize};

use crate::lidar::LaserProfile;
use crate::names::Named;
use crate::odometry::OdometryProfile;
use crate::policy::PolicyKind;
use crate::slam::{SlamKind, WheelCalibration};
use crate::trial::TrialSettings;

/// Greatest number of maps per level.
pub const MAX_MAPS: u32 = 1000;

/// Greatest number of noise seeds per map.
pub const MAX_NOISE_SEEDS: u32 = 1000;

/// Greatest number of columns and of rows of a map.
pub const MAX_SIZE: u32 = 128;

/// Greatest number of trials of a design.
pub const MAX_TRIALS: u64 = 1_000_000;

settings! {
    /// Trials on maps of several levels.
    ///
    /// ```
    /// use mapping_trial::experiment::Design;
    ///
    /// let design = Design::default();
    /// assert_eq!(design.validate(), Ok(()));
    /// assert_eq!(design.trials().len(), 5 * 20 * 5 * 5);
    /// // The paper's ten maps, by five policies.
    /// assert_eq!(design.trials().iter().filter(|trial| design.is_replay(trial)).count(), 50);
    /// ```
    pub struct Design {
        /// The requested difficulties of the maps.
        levels: Vec<f64> = vec![1.0, 3.0, 5.0, 7.0, 9.0] => list(
            "", "two or more difficulties, increasing, from 0 to 10 in tenths", "1,5,9"
        );
        /// Maps per level.
        maps: u32 = 20 => integer("", 2..=MAX_MAPS as u64);
        /// Trials of each policy on each map, which differ in sensor noise.
        noise_seeds: u32 = 5 => integer("", 1..=MAX_NOISE_SEEDS as u64);
        /// The policies, which take the place of the thesis's operators; `operators` in files.
        #[serde(rename = "operators", alias = "policies")]
        policies: Vec<PolicyKind> = default_policies() => list(
            "", "one or more policies, each once", "nearest,corridors"
        );
        /// The design of the paper.
        replay: Replay = Replay::default() => nested;
        /// How maps are generated.
        profile: Profile = Profile::Thesis => choice;
        /// Columns and rows of a map, in cells of 3 m.
        size: u32 = IndoorSpec::default().width => integer("", 4..=MAX_SIZE as u64);
        /// How poses and maps are estimated.
        slam: SlamKind = TrialSettings::default().slam => other("", "an estimator's name");
        /// Which systematic errors of the wheels are learned.
        #[serde(skip_serializing_if = "WheelCalibration::is_default")]
        wheel_calibration: WheelCalibration = TrialSettings::default().wheel_calibration =>
            other("", "none, turns or turns_and_distances");
        /// What the laser measures.
        laser: LaserProfile = TrialSettings::default().laser => nested;
        /// What the wheels measure.
        odometry: OdometryProfile = TrialSettings::default().odometry => nested;
        /// Simulated time after which a trial ends.
        time_limit: f64 = TrialSettings::default().time_limit => other("s", "a time limit that trials can have");
        /// Simulated time per square metre that can be mapped, in place of `time_limit`.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        time_per_area: Option<f64> = None => optional_other("s/m^2", "a time per area that trials can have");
        /// The seed from which the seeds of maps and noise follow.
        seed: Seed = Seed(0) => other("", "a whole number");
    }
}

settings! {
    /// The paper's own design: a few maps per level, on each of which every policy drives once.
    pub struct Replay {
        /// Maps per level, no more than the design has.
        maps: u32 = 2 => integer("", 1..=MAX_MAPS as u64);
        /// The policies, `operators` in files.
        #[serde(rename = "operators", alias = "policies")]
        policies: Vec<PolicyKind> = default_policies() => list(
            "", "one or more policies, each once", "nearest,corridors"
        );
    }
}

/// The identity of a trial within a design.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TrialId {
    /// Index of the level in [`Design::levels`].
    pub level: u32,
    /// Number of the map within its level.
    pub map: u32,
    /// Number of the noise seed on this map.
    pub noise: u32,
    /// The policy. Its name in files is `operator`.
    #[serde(rename = "operator", alias = "policy")]
    pub policy: PolicyKind,
}

/// The policies of the experiments in the guide, which are older than `tour`.
fn default_policies() -> Vec<PolicyKind> {
    use PolicyKind::{Cautious, Corridors, InfoGain, Nearest, WallFollow};
    vec![Nearest, InfoGain, Cautious, WallFollow, Corridors]
}

/// Returns the name of a policy.
pub fn policy_name(kind: PolicyKind) -> &'static str {
    kind.name().unwrap_or("custom")
}

impl Design {
    /// Returns the paper's design together with six maps per level, on each of which the policy
    /// `nearest` drives once. It takes less than two minutes.
    pub fn quick() -> Self {
        Design { maps: 6, noise_seeds: 1, policies: vec![PolicyKind::Nearest], ..Design::default() }
    }

    /// Checks every number.
    ///
    /// # Errors
    ///
    /// Names the first field whose value is not allowed.
    pub fn validate(&self) -> Result<(), SpecError> {
        self.check_fields()?;
        let rising = self.levels.windows(2).all(|pair| pair[0] < pair[1]);
        let tenths = |level: &f64| {
            (0.0..=10.0).contains(level) && (level * 10.0 - (level * 10.0).round()).abs() < 1e-9
        };
        if self.levels.len() < 2 || !rising || !self.levels.iter().all(tenths) {
            let levels: Vec<String> = self.levels.iter().map(f64::to_string).collect();
            return Err(Design::setting("levels").error(levels.join(", ")));
        }
        if self.replay.maps > self.maps {
            let allowed = format!("at most the {} maps of the design", self.maps);
            let error = Replay::setting("maps").error_with(self.replay.maps, allowed);
            return Err(error.within("replay"));
        }
        each_once(&self.policies, &Design::setting("policies"))?;
        each_once(&self.replay.policies, &Replay::setting("policies"))
            .map_err(|error| error.within("replay"))?;
        let main = self.levels.len() as u64 * u64::from(self.maps);
        let all = main * u64::from(self.noise_seeds) * self.policies.len() as u64;
        if all > MAX_TRIALS {
            let allowed =
                format!("at most {MAX_TRIALS} trials with levels, noise seeds and policies");
            return Err(Design::setting("maps").error_with(self.maps, allowed));
        }
        for &level in &self.levels {
            self.spec(level).validate()?;
        }
        self.settings(&TrialId { level: 0, map: 0, noise: 0, policy: PolicyKind::Nearest })
            .validate()
    }

    /// Returns every trial in the order of the design: by level, map, noise and policy.
    pub fn trials(&self) -> Vec<TrialId> {
        let mut trials = Vec::new();
        for level in 0..self.levels.len() as u32 {
            for map in 0..self.maps {
                for noise in 0..self.noise_seeds {
                    for (_, policy) in PolicyKind::NAMES {
                        let trial = TrialId { level, map, noise, policy: *policy };
                        if self.is_main(&trial) || self.is_replay(&trial) {
                            trials.push(trial);
                        }
                    }
                }
            }
        }
        trials
    }

    /// Returns whether a trial belongs to the larger design.
    pub fn is_main(&self, trial: &TrialId) -> bool {
        self.policies.contains(&trial.policy)
    }

    /// Returns whether a trial belongs to the paper's design.
    pub fn is_replay(&self, trial: &TrialId) -> bool {
        trial.noise == 0
            && trial.map < self.replay.maps
            && self.replay.policies.contains(&trial.policy)
    }

    /// Returns the spec of the maps of a level.
    pub fn spec(&self, level: f64) -> IndoorSpec {
        IndoorSpec {
            difficulty: level,
            width: self.size,
            height: self.size,
            profile: self.profile,
            ..IndoorSpec::default()
        }
    }

    /// Returns the requested difficulty of a trial's map.
    ///
    /// # Panics
    ///
    /// If the design does not have the trial's level.
    #[track_caller]
    pub fn level(&self, trial: &TrialId) -> f64 {
        self.levels[trial.level as usize]
    }

    /// Returns the seed of a trial's map. With seed 0, map 4 of level 7 has seed 70004. Maps of
    /// different levels share no draws.
    ///
    /// ```
    /// use mapping_trial::experiment::{Design, TrialId};
    /// use mapping_trial::policy::PolicyKind;
    ///
    /// let design = Design::default();
    /// // The fourth level of the design is 7.
    /// let trial = TrialId { level: 3, map: 4, noise: 0, policy: PolicyKind::Nearest };
    /// assert_eq!((design.level(&trial), design.world_seed(&trial).0), (7.0, 70004));
    /// ```
    pub fn world_seed(&self, trial: &TrialId) -> Seed {
        let tenths = (self.level(trial) * 10.0).round() as u64;
        let own = tenths * u64::from(MAX_MAPS) + u64::from(trial.map);
        Seed(self.seed.0.wrapping_mul(1_000_000).wrapping_add(own))
    }

    /// Returns the seed of a trial's sensor noise, which is the same for all policies and differs from
    /// map to map.
    pub fn noise_seed(&self, trial: &TrialId) -> Seed {
        let maps = self.world_seed(trial).0.wrapping_mul(u64::from(MAX_NOISE_SEEDS));
        Seed(maps).offset(u64::from(trial.noise))
    }

    /// Returns the settings of a trial.
    pub fn settings(&self, trial: &TrialId) -> TrialSettings {
        TrialSettings {
            seed: self.noise_seed(trial),
            policy: Some(trial.policy),
            slam: self.slam,
            wheel_calibration: self.wheel_calibration,
            time_limit: self.time_limit,
            time_per_area: self.time_per_area,
            laser: self.laser.clone(),
            odometry: self.odometry.clone(),
            ..TrialSettings::default()
        }
    }
}

/// A share of a design's trials: every `of`-th, beginning with the `index`-th. It is written as `2/8`.
///
/// ```
/// use mapping_trial::experiment::Shard;
///
/// let shard: Shard = "2/8".parse()?;
/// let places: Vec<_> = (0..20).filter(|&place| shard.has(place)).collect();
/// assert_eq!(places, [1, 9, 17]);
/// assert!("9/8".parse::<Shard>().is_err());
/// # Ok::<(), envgen::SpecError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Shard {
    /// Number of this share, from 1 to `of`.
    pub index: u32,
    /// Number of shares.
    pub of: u32,
}

impl Shard {
    /// The share of all trials.
    pub const WHOLE: Shard = Shard { index: 1, of: 1 };

    /// Checks the numbers.
    ///
    /// # Errors
    ///
    /// If the index is not from 1 to the number of shares.
    pub fn validate(self) -> Result<(), SpecError> {
        if (1..=self.of).contains(&self.index) {
            return Ok(());
        }
        Err(SpecError::new("shard", self, "I/N with I from 1 to N, such as 2/8"))
    }

    /// Returns whether the trial at an index of the design's order belongs to this share.
    ///
    /// # Panics
    ///
    /// If the number of shares is 0.
    #[track_caller]
    pub fn has(self, place: usize) -> bool {
        assert!(self.of > 0, "`of` is 0 shares");
        place as u64 % u64::from(self.of) + 1 == u64::from(self.index)
    }

    /// Does the same as [`Shard::has`] where items of several kinds take turns, so that each share gets
    /// every kind.
    #[track_caller]
    pub(crate) fn has_of(self, place: usize, kinds: usize) -> bool {
        let kinds = kinds.max(1);
        // The first item of a round belongs to another share than the first of the round before.
        self.has(place / kinds + place % kinds)
    }
}

impl fmt::Display for Shard {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}/{}", self.index, self.of)
    }
}

impl FromStr for Shard {
    type Err = SpecError;

    fn from_str(text: &str) -> Result<Self, SpecError> {
        let parts = text.split_once('/').map(|(index, of)| (index.parse(), of.parse()));
        let shard = match parts {
            Some((Ok(index), Ok(of))) => Some(Shard { index, of }),
            _ => None,
        };
        let shard = shard.filter(|shard| shard.validate().is_ok());
        shard.ok_or_else(|| SpecError::new("shard", text, "I/N with I from 1 to N, such as 2/8"))
    }
}

/// Checks a list of policies.
fn each_once(policies: &[PolicyKind], setting: &Setting) -> Result<(), SpecError> {
    let twice = policies.iter().enumerate().any(|(i, one)| policies[..i].contains(one));
    if policies.is_empty() || twice {
        let names: Vec<_> = policies.iter().map(|&kind| policy_name(kind)).collect();
        return Err(setting.error(names.join(", ")));
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn trials_are_the_union_of_both_designs() {
        let quick = Design::quick();
        assert_eq!(quick.validate(), Ok(()));
        let trials = quick.trials();
        // 5 x 2 x 5 of the paper's design, and the four other maps of each level by `nearest`.
        assert_eq!(trials.len(), 50 + 20);
        assert_eq!(trials.iter().filter(|trial| quick.is_replay(trial)).count(), 50);
        assert_eq!(trials.iter().filter(|trial| quick.is_main(trial)).count(), 30);
    }

    #[test]
    fn seeds_of_maps_and_noise_are_all_different() {
        let design = Design { maps: 40, noise_seeds: 7, ..Design::default() };
        let trials = design.trials();
        let mut worlds: Vec<Seed> = trials.iter().map(|trial| design.world_seed(trial)).collect();
        worlds.sort_unstable();
        worlds.dedup();
        assert_eq!(worlds.len(), 5 * 40);
        let mut noise: Vec<Seed> = trials.iter().map(|trial| design.noise_seed(trial)).collect();
        noise.sort_unstable();
        noise.dedup();
        assert_eq!(noise.len(), 5 * 40 * 7);
        let trial = TrialId { level: 3, map: 4, noise: 2, policy: PolicyKind::Nearest };
        assert_eq!(design.world_seed(&trial), Seed(70_004));
        assert_eq!(design.noise_seed(&trial), Seed(70_004_002));
        // Neither seed of an experiment is one of the next.
        let next = Design { seed: Seed(1), ..design };
        assert!(trials.iter().all(|trial| worlds.binary_search(&next.world_seed(trial)).is_err()));
    }

    #[test]
    fn files_call_policies_operators() {
        let design = Design::quick();
        let text = serde_json::to_string(&design).expect("JSON");
        assert!(text.contains("\"operators\":[\"nearest\"]"), "{text}");
        let text = text.replace("operators", "policies");
        assert_eq!(serde_json::from_str::<Design>(&text).expect("a design"), design);
    }

    #[test]
    fn shards_part_the_trials() {
        let trials = Design::quick().trials();
        for of in [1, 2, 3, 7, 100] {
            for place in 0..trials.len() {
                let owners = (1..=of).filter(|&index| Shard { index, of }.has(place)).count();
                assert_eq!(owners, 1);
            }
        }
        assert_eq!("3/7".parse(), Ok(Shard { index: 3, of: 7 }));
        for bad in ["0/3", "4/3", "3", "", "a/b", "1/0", "-1/3", "1/3/5"] {
            let error = bad.parse::<Shard>().expect_err("no shard").to_string();
            assert!(error.starts_with("`shard` must be "), "{error}");
        }
    }

    #[test]
    fn shards_get_every_kind() {
        for (kinds, of) in [(1, 3), (2, 2), (2, 4), (3, 2), (4, 2), (3, 3), (6, 4)] {
            let maps = 4 * of as usize * kinds;
            for index in 1..=of {
                let shard = Shard { index, of };
                let own: Vec<usize> =
                    (0..maps).filter(|&place| shard.has_of(place, kinds)).collect();
                for kind in 0..kinds {
                    let count = own.iter().filter(|&&place| place % kinds == kind).count();
                    assert_eq!(count, 4, "{kinds} kinds, share {shard}");
                }
            }
        }
    }

    #[test]
    fn every_bad_number_is_named() {
        let error = |change: &dyn Fn(&mut Design)| {
            let mut design = Design::default();
            change(&mut design);
            design.validate().expect_err("not allowed").to_string()
        };
        assert!(error(&|d| d.levels = vec![1.0]).starts_with("`levels` must be"));
        assert!(error(&|d| d.levels = vec![3.0, 1.0]).contains("increasing"));
        assert!(error(&|d| d.levels = vec![1.0, f64::NAN]).contains("NaN"));
        assert!(error(&|d| d.levels = vec![1.0, 2.55]).contains("tenths"));
        assert!(error(&|d| d.levels = vec![1.0, 11.0]).contains("from 0 to 10"));
        assert!(
            error(&|d| d.maps = 1).contains("`maps` must be a whole number from 2 to 1000, got 1")
        );
        assert!(error(&|d| d.noise_seeds = 0).contains("`noise_seeds`"));
        assert!(error(&|d| d.replay.maps = 21).contains("`replay.maps`"));
        assert!(error(&|d| d.policies.clear()).contains("`policies`"));
        assert!(error(&|d| d.policies.push(PolicyKind::Nearest)).contains("each once"));
        assert!(error(&|d| d.size = 3).contains("`size` must be"));
        assert!(error(&|d| d.size = u32::MAX).contains("`size`"));
        assert!(error(&|d| d.time_limit = f64::NAN).contains("`time_limit`"));
        assert!(error(&|d| d.time_per_area = Some(0.0)).contains("`time_per_area`"));
        assert!(error(&|d| (d.maps, d.noise_seeds) = (1000, 1000)).contains("1000000"));
    }
}
