//! The table of file formats.

use std::fmt;
use std::io::Write;
use std::path::Path;

use super::asc::write_asc;
use super::error::ExportError;
use super::job::Job;
#[cfg(feature = "usarsim")]
use crate::spec::WorldBlueprint;

/// A function that writes one file of a format.
pub type Writer = fn(&Job<'_>, &mut dyn Write) -> Result<(), ExportError>;

/// One line per format: the feature that it needs, the variant, a summary, and its files, each with an ending and a
/// writer.
macro_rules! formats {
    ($($(#[cfg(feature = $feature:literal)])? $variant:ident, $doc:literal,
        [$($ending:literal => $writer:expr),+];)+) => {
        /// A file format in which worlds can be written.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
        #[non_exhaustive]
        pub enum Format {
            $($(#[cfg(feature = $feature)])? #[doc = $doc] $variant,)+
        }

        /// The endings of each format and the feature that it needs, including formats that this build does not have.
        const NEEDED: &[(&[&str], &[&str])] = &[$((&[$($ending),+], &[$($feature)?])),+];

        impl Format {
            /// Every format of this build.
            pub const ALL: &'static [Format] = &[$($(#[cfg(feature = $feature)])? Format::$variant),+];

            /// Returns a summary of the format in one sentence.
            pub fn summary(self) -> &'static str {
                match self {
                    $($(#[cfg(feature = $feature)])? Format::$variant => $doc.trim_ascii(),)+
                }
            }

            /// Returns the format's files: the ending of each and its writer. The first ending is the one by which
            /// [`Format::from_path`] recognises the format.
            pub fn files(self) -> &'static [(&'static str, Writer)] {
                match self {
                    $($(#[cfg(feature = $feature)])? Format::$variant => &[$(($ending, $writer as Writer)),+],)+
                }
            }
        }
    };
}

formats! {
    Json, " The whole world as JSON, for reading back.",
        ["json" => |job, out| Ok(job.world.write_json(out)?)];
    Ron, " The whole world as RON, one line per part, for reading back.",
        ["ron" => |job, out| Ok(job.world.write_ron(out)?)];
    Scenario, " What moves in the world as RON: doors, people and smoke.",
        ["scenario.ron" => |job, out| job.write_scenario(out)];
    #[cfg(feature = "opendrive")]
    OpenDrive, " The roads, and what is solid, as OpenDRIVE 1.7.",
        ["xodr" => |job, out| super::opendrive::write(job.world, out)];
    #[cfg(feature = "csv")]
    Csv, " The waypoints of the roads as comma-separated values.",
        ["csv" => |job, out| super::csv::write(job.world, out)];
    #[cfg(feature = "csv")]
    ObstaclesCsv, " What is solid, start, goal and victims as comma-separated values.",
        ["obstacles.csv" => |job, out| super::obstacles_csv::write(job.world, out)];
    #[cfg(feature = "geojson")]
    GeoJson, " All parts, start and goal as GeoJSON, in metres.",
        ["geojson" => |job, out| super::geojson::write(job.world, out)];
    HouseExpo, " The outline of the free ground and the rooms as in the data set HouseExpo.",
        ["house.json" => |job, out| super::houseexpo::write(job.world, &job.stem, job.resolution, out)];
    #[cfg(feature = "rmf")]
    Building, " Walls, doors and lanes as a building of Open-RMF.",
        ["building.yaml" => |job, out| super::building::write(job.world, out)];
    #[cfg(feature = "usarsim")]
    WorldGenerator, " An indoor plan as a project of the World Generator for USARSim.",
        ["xml" => write_world_generator];
    #[cfg(feature = "sdf")]
    Sdf, " The world in three dimensions for Gazebo, as SDFormat 1.9.",
        ["sdf" => |job, out| super::sdf::write(job.world, out)];
    #[cfg(feature = "mjcf")]
    Mjcf, " The world in three dimensions for MuJoCo.",
        ["mjcf.xml" => |job, out| super::mjcf::write(job.world, out)];
    #[cfg(feature = "gltf")]
    Gltf, " The world in three dimensions as meshes in glTF 2.0, in one binary file.",
        ["glb" => |job, out| super::gltf::write(job.world, out)];
    #[cfg(feature = "usd")]
    Usd, " The world in three dimensions as Universal Scene Description, in text.",
        ["usda" => |job, out| super::usd::write(job.world, out)];
    #[cfg(feature = "picture")]
    Svg, " A vector picture.",
        ["svg" => |job, out| Ok(crate::picture::write_svg(job.world, &job.picture, out)?)];
    #[cfg(feature = "picture")]
    Png, " A picture in pixels.",
        ["png" => |job, out| Ok(crate::picture::write_png(job.world, &job.picture, out)?)];
    Asc, " A landscape's classes as an ESRI ASCII grid.",
        ["asc" => |job, out| Ok(write_asc(job.raster()?, job.class_labels().as_deref(), out)?)];
    #[cfg(feature = "picture")]
    ClassPng, " A landscape's classes as an image, one pixel per cell.",
        ["classes.png" => |job, out| Ok(super::class_png::write_class_png(job.raster()?, out)?)];
    #[cfg(feature = "paths")]
    MovingAi, " Where a landscape can be passed as a MovingAI map, with a scenario of 100 tasks.",
        ["map" => |job, out| Ok(super::movingai::write_map(job.raster()?, out)?),
         "scen" => |job, out| job.write_scenarios(out)];
    RosMap, " What is solid as a map for ROS and Nav2, a description and an image.",
        ["yaml" => |job, out| job.write_ros_description(out),
         "pgm" => |job, out| job.write_ros_image(out)];
}

#[cfg(feature = "usarsim")]
fn write_world_generator(job: &Job<'_>, mut out: &mut dyn Write) -> Result<(), ExportError> {
    match job.blueprint {
        Some(WorldBlueprint::Indoor(plan)) => {
            Ok(crate::indoor::world_generator::write_project(plan, &job.stem, &mut out)?)
        }
        _ => Err(ExportError::Blueprint {
            format: "a World Generator project",
            wanted: "the plan of an indoor map",
        }),
    }
}

impl Format {
    /// Returns the ending of the format's first file, without the dot.
    pub fn ending(self) -> &'static str {
        self.files()[0].0
    }

    /// Returns whether a world is enough for the format: it needs neither the plan from which the world was built nor
    /// what moves in it.
    pub fn needs_only_a_world(self) -> bool {
        match self {
            Format::Scenario => false,
            #[cfg(feature = "usarsim")]
            Format::WorldGenerator => false,
            _ => true,
        }
    }

    /// Returns the format that the ending of a file's name selects, in upper or lower case.
    ///
    /// ```
    /// use envgen::export::Format;
    ///
    /// let format = Format::from_path("maps/Office.JSON".as_ref())?;
    /// assert_eq!(format.ending(), "json");
    /// // Of two endings that match, the longer one is meant.
    /// let scenario = Format::from_path("office.scenario.ron".as_ref())?;
    /// assert_eq!(scenario.ending(), "scenario.ron");
    /// assert!(Format::from_path("office.doc".as_ref()).is_err());
    /// # Ok::<(), envgen::export::ExportError>(())
    /// ```
    ///
    /// # Errors
    /// Returns an error that lists the endings that exist, or that names the feature of the crate that the format
    /// needs.
    pub fn from_path(path: &Path) -> Result<Format, ExportError> {
        let name = path.file_name().map(|name| name.to_string_lossy().to_ascii_lowercase());
        let ends = |ending: &str| {
            let stem = name.as_ref()?.strip_suffix(ending)?.strip_suffix('.')?;
            (!stem.is_empty()).then_some(())
        };
        // Of two endings that match, such as `classes.png` and `png`, the longer one is meant.
        let fitting = NEEDED.iter().map(|(endings, features)| (endings[0], features));
        let meant = fitting.filter(|(ending, _)| ends(ending).is_some());
        let Some((ending, features)) = meant.max_by_key(|(ending, _)| ending.len()) else {
            return Err(ExportError::UnknownEnding {
                path: path.to_owned(),
                known: Format::endings(|_| true),
            });
        };
        let format = Format::ALL.iter().copied().find(|format| format.ending() == ending);
        format.ok_or_else(|| ExportError::Feature {
            path: path.to_owned(),
            feature: features.first().copied().unwrap_or_default(),
        })
    }

    /// Returns the endings of some formats of this build, as a list for an error.
    pub fn endings(of: impl Fn(Format) -> bool) -> String {
        let some = Format::ALL.iter().filter(|format| of(**format));
        some.map(|format| format!(".{format}")).collect::<Vec<_>>().join(", ")
    }

    /// Writes the format's first file, which is the only one for most formats.
    ///
    /// # Errors
    /// When the format cannot contain the world, or when writing fails.
    pub fn write(self, job: &Job<'_>, out: &mut dyn Write) -> Result<(), ExportError> {
        (self.files()[0].1)(job, out)
    }
}

impl fmt::Display for Format {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.ending())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeSet;

    #[test]
    fn endings_find_their_format() {
        let mut endings = BTreeSet::new();
        for &format in Format::ALL {
            assert!(endings.insert(format.ending()), "{format} is listed twice");
            for name in [format!("a.b.{format}"), format!("A.{format}").to_uppercase()] {
                assert_eq!(Format::from_path(Path::new(&name)).unwrap(), format);
            }
        }
    }

    #[test]
    fn formats_of_other_builds_name_their_feature() {
        for (endings, features) in NEEDED {
            let name = format!("a.{}", endings[0]);
            match Format::from_path(Path::new(&name)) {
                Ok(format) => assert_eq!(format.ending(), endings[0]),
                Err(error) => {
                    let (error, feature) = (error.to_string(), features[0]);
                    let expected = format!("`{name}` needs the feature `{feature}`");
                    assert!(error.starts_with(&expected), "{error}");
                    assert!(error.contains(&format!("--features cli,{feature}`")), "{error}");
                }
            }
        }
        let has_usd = Format::from_path(Path::new("a.usda")).is_ok();
        assert_eq!(has_usd, cfg!(feature = "usd"));
    }

    #[test]
    fn unknown_endings_list_what_exists() {
        for name in ["world", "world.xyz", ".json", ""] {
            let error = Format::from_path(Path::new(name)).unwrap_err().to_string();
            assert!(
                error.contains(&format!("`{name}`")) && error.contains(".json, .ron"),
                "{error}"
            );
        }
    }
}
