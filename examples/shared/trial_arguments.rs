//! The arguments of all programs that run trials. Their help, names and defaults come from the trial's
//! settings.

use clap::Args;
use clap::builder::{PossibleValuesParser, TypedValueParser};
use mapping_trial::lidar::LaserProfile;
use mapping_trial::names::Named;
use mapping_trial::profile::{Profile, named_or_read};
use mapping_trial::slam::{SlamKind, WheelCalibration};
use mapping_trial::trial::TrialSettings;

/// How trials measure, and how long they take.
#[derive(Args, Clone)]
pub(crate) struct TrialArguments {
    #[arg(long, help = help("slam"), value_parser = named::<SlamKind>(),
          default_value = name(|settings| &settings.slam))]
    pub(crate) slam: SlamKind,

    #[arg(long, help = help("wheel_calibration"), value_name = "ERRORS",
          value_parser = named::<WheelCalibration>(),
          default_value = name(|settings| &settings.wheel_calibration))]
    pub(crate) wheel_calibration: WheelCalibration,

    #[arg(long, help = profile_help::<LaserProfile>("laser"), value_name = "NAME|FILE.ron",
          value_parser = named_or_read::<LaserProfile>, default_value = name(|settings| &settings.laser))]
    pub(crate) laser: LaserProfile,

    #[arg(long, help = help("time_limit"), value_name = "SECONDS",
          default_value_t = TrialSettings::default().time_limit)]
    pub(crate) time_limit: f64,

    #[arg(long, help = help("time_per_area"), value_name = "SECONDS", conflicts_with = "time_limit")]
    pub(crate) time_per_area: Option<f64>,
}

/// Returns the help for a setting of a trial, with its unit.
pub(crate) fn help(setting: &str) -> String {
    let setting = TrialSettings::setting(setting);
    let unit = if setting.unit.is_empty() { String::new() } else { format!(" [{}]", setting.unit) };
    format!("{}{unit}", setting.help.replace("`time_limit`", "--time-limit"))
}

/// Returns a parser for the names of values.
pub(crate) fn named<T: Named + Send + Sync>() -> impl TypedValueParser<Value = T> {
    PossibleValuesParser::new(T::NAMES.iter().map(|(name, _)| *name))
        .try_map(|name| T::named(&name))
}

/// Returns the help for the profile of a part of the robot.
pub(crate) fn profile_help<T: Profile>(part: &str) -> String {
    let names: Vec<&str> = T::NAMES.iter().map(|(name, _)| *name).collect();
    format!("The {part}: {}, or a RON file such as `{}`", names.join(", "), T::EXAMPLE)
}

/// Returns the name of the default value of a setting.
pub(crate) fn name<T: Named>(of: impl Fn(&TrialSettings) -> &T) -> &'static str {
    of(&TrialSettings::default()).name().unwrap_or_default()
}
