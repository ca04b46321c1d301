//! Pictures of worlds in three dimensions.

use bevy::prelude::*;
use bevy_envgen::prelude::{
    EnvgenPlugins, EnvgenVisuals3dPlugin, Environment, EnvironmentFailure, GenerationMode,
    Visuals3dSettings,
};
use bevy_offscreen::{Picture, Studio};

use crate::{SIZE, spec};

/// A world, and from where it is seen.
pub(crate) struct Scene {
    pub(crate) name: &'static str,
    kind: &'static str,
    settings: &'static [(&'static str, &'static str)],
    seed: u64,
    /// Whether rooms have ceilings.
    ceilings: bool,
    /// The position of the camera and a point that it looks at, in metres.
    from: Vec3,
    to: Vec3,
}

/// Field of view from bottom to top in radians.
const FIELD_OF_VIEW: f32 = 0.8;

/// Every kind of world.
pub(crate) const SCENES: &[Scene] = &[
    Scene {
        name: "indoor_3d",
        kind: "indoor",
        settings: &[("difficulty", "5"), ("width", "16"), ("height", "12")],
        seed: 4,
        ceilings: false,
        from: Vec3::new(24.0, -20.0, 34.0),
        to: Vec3::new(24.0, 15.0, 0.0),
    },
    Scene {
        name: "room_3d",
        kind: "indoor",
        settings: &[("difficulty", "5"), ("width", "16"), ("height", "12")],
        seed: 4,
        ceilings: true,
        from: Vec3::new(20.0, 16.0, 1.6),
        to: Vec3::new(30.0, 18.0, 1.2),
    },
    Scene {
        name: "hallway_3d",
        kind: "hallway",
        settings: &[("segments", "14"), ("p_st", "0.4"), ("door_frame_rate", "0.1")],
        seed: 7,
        ceilings: false,
        from: Vec3::new(-6.0, -14.0, 14.0),
        to: Vec3::new(8.0, 2.0, 0.0),
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
        ceilings: false,
        from: Vec3::new(-6.0, 8.0, 1.8),
        to: Vec3::new(20.0, 16.0, 1.6),
    },
    Scene {
        name: "road_3d",
        kind: "road",
        settings: &[],
        seed: 2,
        ceilings: false,
        from: Vec3::new(-30.0, -60.0, 60.0),
        to: Vec3::new(60.0, 40.0, 0.0),
    },
    Scene {
        name: "landscape_3d",
        kind: "landscape",
        settings: &[("algorithm", "smooth"), ("entropy", "1.9"), ("total_edge", "700")],
        seed: 3,
        ceilings: false,
        from: Vec3::new(16.0, -14.0, 20.0),
        to: Vec3::new(16.0, 12.0, 0.0),
    },
    Scene {
        name: "cellular_3d",
        kind: "cellular",
        settings: &[],
        seed: 1,
        ceilings: false,
        from: Vec3::new(2.0, -3.0, 5.0),
        to: Vec3::new(2.5, 2.0, 0.0),
    },
];

/// A picture of a world as the plugin draws it.
pub(crate) fn draw(scene: &Scene) -> Result<Picture, Box<dyn std::error::Error>> {
    let mut studio = Studio::new()?;
    let settings = Visuals3dSettings { ceilings: scene.ceilings, ..default() };
    studio.app().add_plugins((EnvgenPlugins::default(), EnvgenVisuals3dPlugin::new(settings)));
    let environment = Environment::new(spec(scene.kind, scene.settings)?, scene.seed);
    let environment = environment.with_pace(GenerationMode::Blocking);
    let world = studio.app().world_mut().spawn(environment).id();
    studio.step()?;
    if let Some(failure) = studio.app().world().get::<EnvironmentFailure>(world) {
        return Err(failure.0.clone().into());
    }
    let pose = Transform::from_translation(scene.from).looking_at(scene.to, Vec3::Z);
    let camera = studio.camera_3d(pose, FIELD_OF_VIEW, SIZE)?;
    Ok(studio.picture(camera)?)
}
