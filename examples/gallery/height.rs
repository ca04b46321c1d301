//! Pictures of worlds in three dimensions.

use std::time::Duration;

use bevy::math::ops;
use bevy::prelude::*;
use bevy_envgen::prelude::{
    EnvgenPlugins, EnvgenVisuals3dPlugin, Environment, EnvironmentFailure, EnvironmentScenario,
    GenerationMode, GroundTruth, ScenarioSpec, Visuals3dSettings,
};
use bevy_offscreen::{CapturedImage, Studio};

use crate::worlds::{corridor, spec};

/// A world, with the viewpoint from which it is seen.
pub(crate) struct Scene {
    pub(crate) name: &'static str,
    world: Source,
    view: View,
}

/// The source of a world.
enum Source {
    /// A kind with settings and a seed, and what moves in the world.
    Spec {
        kind: &'static str,
        settings: &'static [(&'static str, &'static str)],
        seed: u64,
        moving: &'static [(&'static str, &'static str)],
    },
    /// The corridor of the film.
    Corridor,
}

impl Source {
    /// Returns the environment, and its scenario.
    fn request(
        &self,
    ) -> Result<(Environment, Option<EnvironmentScenario>), Box<dyn std::error::Error>> {
        match *self {
            Source::Corridor => {
                let (world, moving) = corridor();
                let moving = EnvironmentScenario::prebuilt(moving);
                Ok((Environment::prebuilt(world), Some(moving)))
            }
            Source::Spec { kind, settings, seed, moving } => {
                let mut scenario = ScenarioSpec::default();
                for (name, value) in moving {
                    scenario.set(name, value)?;
                }
                let moving =
                    (!scenario.is_still()).then(|| EnvironmentScenario::new(scenario, seed));
                Ok((Environment::new(spec(kind, settings)?, seed), moving))
            }
        }
    }
}

/// The viewpoint of a picture.
enum View {
    /// The whole world from above. `heading` and `elevation` are the direction from which it is seen,
    /// in degrees from the x axis and above the floor. `nearness` is 1 for a distance at which a sphere
    /// around the world fits.
    Tilted { heading: f32, elevation: f32, nearness: f32 },
    /// From a point in the world towards another one, below ceilings.
    Inside { from: Vec3, to: Vec3 },
}

impl View {
    /// Returns the pose of the camera for a world with these bounds.
    fn pose(&self, bounds: Rect) -> Transform {
        match *self {
            View::Inside { from, to } => Transform::from_translation(from).looking_at(to, Vec3::Z),
            View::Tilted { heading, elevation, nearness } => {
                let (heading, elevation) = (heading.to_radians(), elevation.to_radians());
                let outward =
                    Quat::from_rotation_z(heading) * Quat::from_rotation_y(-elevation) * Vec3::X;
                let distance = bounds.half_size().length() / ops::sin(0.5 * FIELD_OF_VIEW);
                let middle = bounds.center().extend(0.0);
                Transform::from_translation(middle + outward * distance / nearness)
                    .looking_at(middle, Vec3::Z)
            }
        }
    }
}

/// Width and height of the pictures in pixels.
const SIZE: UVec2 = UVec2::new(720, 540);

/// Vertical field of view in radians.
const FIELD_OF_VIEW: f32 = 0.8;

/// Simulated time after which the picture is taken if something moves.
const TIME: Duration = Duration::from_secs(12);

/// The pictures, with every kind of world.
pub(crate) const SCENES: &[Scene] = &[
    Scene {
        name: "indoor_3d",
        world: Source::Spec {
            kind: "indoor",
            settings: &[("difficulty", "5"), ("width", "16"), ("height", "12")],
            seed: 4,
            moving: &[],
        },
        view: View::Tilted { heading: -105.0, elevation: 46.0, nearness: 1.32 },
    },
    Scene {
        name: "room_3d",
        world: Source::Spec {
            kind: "indoor",
            settings: &[("difficulty", "5"), ("width", "16"), ("height", "12")],
            seed: 4,
            moving: &[("doors", "0.8"), ("people", "12")],
        },
        view: View::Inside { from: Vec3::new(15.6, 0.7, 1.6), to: Vec3::new(20.0, 5.0, 1.2) },
    },
    Scene {
        name: "smoke_3d",
        world: Source::Corridor,
        view: View::Inside { from: Vec3::new(1.2, 2.3, 1.7), to: Vec3::new(10.0, 1.5, 1.2) },
    },
    Scene {
        name: "hallway_3d",
        world: Source::Spec {
            kind: "hallway",
            settings: &[("segments", "14"), ("p_st", "0.4"), ("door_frame_rate", "0.1")],
            seed: 7,
            moving: &[],
        },
        view: View::Tilted { heading: -120.0, elevation: 42.0, nearness: 1.3 },
    },
    Scene {
        name: "forest_3d",
        world: Source::Spec {
            kind: "forest",
            settings: &[
                ("width", "40"),
                ("height", "30"),
                ("min_distance", "1.5"),
                ("intensity", "0.15"),
                ("radius", "0.2"),
            ],
            seed: 2,
            moving: &[],
        },
        view: View::Inside { from: Vec3::new(-6.0, 8.0, 1.8), to: Vec3::new(20.0, 16.0, 1.9) },
    },
    Scene {
        name: "road_3d",
        world: Source::Spec { kind: "road", settings: &[], seed: 2, moving: &[] },
        view: View::Inside { from: Vec3::new(-16.0, -11.0, 7.0), to: Vec3::new(40.0, 6.0, 0.0) },
    },
    Scene {
        name: "landscape_3d",
        world: Source::Spec {
            kind: "landscape",
            settings: &[
                ("algorithm", "smooth"),
                ("entropy", "1.9"),
                ("total_edge", "700"),
                ("speeds", "1,0.6,1,0.4,0,1,1,1,1"),
            ],
            seed: 3,
            moving: &[],
        },
        view: View::Tilted { heading: -110.0, elevation: 42.0, nearness: 1.5 },
    },
    Scene {
        name: "cellular_3d",
        world: Source::Spec { kind: "cellular", settings: &[], seed: 1, moving: &[] },
        view: View::Tilted { heading: -105.0, elevation: 48.0, nearness: 1.2 },
    },
];

/// Draws a world as the plugin does.
pub(crate) fn draw(scene: &Scene) -> Result<CapturedImage, Box<dyn std::error::Error>> {
    let mut studio = Studio::new()?;
    let ceilings = matches!(scene.view, View::Inside { .. });
    let settings = Visuals3dSettings { ceilings, ..default() };
    studio.app().add_plugins((EnvgenPlugins::default(), EnvgenVisuals3dPlugin::new(settings)));
    let (environment, moving) = scene.world.request()?;
    let environment = environment.with_pace(GenerationMode::Blocking);
    let world = studio.app().world_mut().spawn(environment.clone()).id();
    let moves = moving.is_some();
    studio.set_frame_time(Duration::ZERO);
    if let Some(moving) = moving {
        studio.app().world_mut().entity_mut(world).insert(moving);
    }
    studio.step()?;
    let root = studio.app().world().entity(world);
    if let Some(failure) = root.get::<EnvironmentFailure>() {
        return Err(failure.0.clone().into());
    }
    let truth = root.get::<GroundTruth>().ok_or("the world is not ready")?;
    let area = environment.area_in_app(&GlobalTransform::IDENTITY, truth.bounds);
    if moves {
        studio.app().world_mut().resource_mut::<Time<Virtual>>().set_max_delta(TIME);
        studio.set_frame_time(TIME);
        studio.step()?;
    }
    let camera = studio.camera_3d(scene.view.pose(area), FIELD_OF_VIEW, SIZE)?;
    Ok(studio.picture(camera)?)
}
