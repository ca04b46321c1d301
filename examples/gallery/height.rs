//! Pictures of worlds in three dimensions.

use bevy::prelude::*;
use bevy_envgen::prelude::{
    EnvgenPlugins, EnvgenVisuals3dPlugin, Environment, EnvironmentFailure, EnvironmentScenario,
    GenerationMode, GroundTruth, ScenarioRun, ScenarioSpec, Visuals3dSettings,
};
use bevy_offscreen::{Picture, Studio};

use crate::{SIZE, spec};

/// A world, and from where it is seen.
pub(crate) struct Scene {
    pub(crate) name: &'static str,
    kind: &'static str,
    settings: &'static [(&'static str, &'static str)],
    seed: u64,
    /// What moves in it.
    moving: &'static [(&'static str, &'static str)],
    view: View,
}

/// From where a world is seen.
enum View {
    /// From above, all of it: the direction from which one looks, in degrees from the x axis and above the floor, and
    /// how near, 1 for a sphere around the world that fits.
    Tilted { heading: f32, elevation: f32, nearness: f32 },
    /// From a point in it to another one, below ceilings.
    Inside { from: Vec3, to: Vec3 },
}

impl View {
    /// Where the camera is, for a world of an extent.
    fn pose(&self, bounds: Rect) -> Transform {
        match *self {
            View::Inside { from, to } => Transform::from_translation(from).looking_at(to, Vec3::Z),
            View::Tilted { heading, elevation, nearness } => {
                let (heading, elevation) = (heading.to_radians(), elevation.to_radians());
                let outward =
                    Quat::from_rotation_z(heading) * Quat::from_rotation_y(-elevation) * Vec3::X;
                let distance = bounds.half_size().length() / (0.5 * FIELD_OF_VIEW).sin();
                let middle = bounds.center().extend(0.0);
                Transform::from_translation(middle + outward * distance / nearness)
                    .looking_at(middle, Vec3::Z)
            }
        }
    }
}

/// Field of view from bottom to top in radians.
const FIELD_OF_VIEW: f32 = 0.8;

/// Simulated seconds after which the picture is taken.
const SECONDS: f32 = 12.0;

/// Every kind of world.
pub(crate) const SCENES: &[Scene] = &[
    Scene {
        name: "indoor_3d",
        kind: "indoor",
        settings: &[("difficulty", "5"), ("width", "16"), ("height", "12")],
        seed: 4,
        moving: &[],
        view: View::Tilted { heading: -105.0, elevation: 46.0, nearness: 1.45 },
    },
    Scene {
        name: "room_3d",
        kind: "indoor",
        settings: &[("difficulty", "5"), ("width", "16"), ("height", "12")],
        seed: 4,
        moving: &[("doors", "0.8"), ("people", "12")],
        view: View::Inside { from: Vec3::new(15.6, 0.7, 1.6), to: Vec3::new(20.0, 5.0, 1.2) },
    },
    Scene {
        name: "smoke_3d",
        kind: "indoor",
        settings: &[("difficulty", "5"), ("width", "16"), ("height", "12")],
        seed: 4,
        moving: &[("doors", "0.5"), ("people", "12"), ("smoke", "0.5")],
        view: View::Inside { from: Vec3::new(20.0, 16.0, 1.6), to: Vec3::new(30.0, 18.0, 1.2) },
    },
    Scene {
        name: "hallway_3d",
        kind: "hallway",
        settings: &[("segments", "14"), ("p_st", "0.4"), ("door_frame_rate", "0.1")],
        seed: 7,
        moving: &[],
        view: View::Tilted { heading: -120.0, elevation: 42.0, nearness: 1.3 },
    },
    Scene {
        name: "forest_3d",
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
        view: View::Inside { from: Vec3::new(-6.0, 8.0, 1.8), to: Vec3::new(20.0, 16.0, 1.9) },
    },
    Scene {
        name: "road_3d",
        kind: "road",
        settings: &[],
        seed: 2,
        moving: &[],
        view: View::Inside { from: Vec3::new(-16.0, -11.0, 7.0), to: Vec3::new(40.0, 6.0, 0.0) },
    },
    Scene {
        name: "landscape_3d",
        kind: "landscape",
        settings: &[
            ("algorithm", "smooth"),
            ("entropy", "1.9"),
            ("total_edge", "700"),
            ("speeds", "1,0.6,1,0.4,0,1,1,1,1"),
        ],
        seed: 3,
        moving: &[],
        view: View::Tilted { heading: -110.0, elevation: 42.0, nearness: 1.5 },
    },
    Scene {
        name: "cellular_3d",
        kind: "cellular",
        settings: &[],
        seed: 1,
        moving: &[],
        view: View::Tilted { heading: -105.0, elevation: 48.0, nearness: 1.2 },
    },
];

/// A picture of a world as the plugin draws it.
pub(crate) fn draw(scene: &Scene) -> Result<Picture, Box<dyn std::error::Error>> {
    let mut studio = Studio::new()?;
    let ceilings = matches!(scene.view, View::Inside { .. });
    let settings = Visuals3dSettings { ceilings, ..default() };
    studio.app().add_plugins((EnvgenPlugins::default(), EnvgenVisuals3dPlugin::new(settings)));
    let environment = Environment::new(spec(scene.kind, scene.settings)?, scene.seed);
    let environment = environment.with_pace(GenerationMode::Blocking);
    let mut moving = ScenarioSpec::default();
    for (name, value) in scene.moving {
        moving.set(name, value)?;
    }
    let world = studio.app().world_mut().spawn(environment.clone()).id();
    if !moving.is_still() {
        let request = EnvironmentScenario::new(moving, scene.seed);
        studio.app().world_mut().entity_mut(world).insert(request);
    }
    studio.step()?;
    let root = studio.app().world().entity(world);
    if let Some(failure) = root.get::<EnvironmentFailure>() {
        return Err(failure.0.clone().into());
    }
    let truth = root.get::<GroundTruth>().ok_or("the world is not ready")?;
    let area = environment.area_in_app(&GlobalTransform::IDENTITY, truth.bounds);
    if root.contains::<ScenarioRun>() {
        for _ in 0..(SECONDS * 64.0) as u32 {
            studio.step()?;
        }
    }
    let mut pose = scene.view.pose(area);
    if let Ok(text) = std::env::var("LOOK") {
        let n: Vec<f32> = text.split(',').map(|n| n.parse().unwrap()).collect();
        pose =
            Transform::from_xyz(n[0], n[1], n[2]).looking_at(Vec3::new(n[3], n[4], n[5]), Vec3::Z);
    }
    let camera = studio.camera_3d(pose, FIELD_OF_VIEW, SIZE)?;
    Ok(studio.picture(camera)?)
}
