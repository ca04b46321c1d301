//! The sky in the background.

use bevy::asset::RenderAssetUsages;
use bevy::light::Skybox;
use bevy::prelude::*;
use bevy::render::render_resource::{
    Extent3d, TextureDimension, TextureFormat, TextureViewDescriptor, TextureViewDimension,
};

use super::glow::INTENSITY;
use super::settings::Visuals3dSettings;

/// A component that gives a [`Camera3d`] a sky with haze at the horizon. [`Visuals3dSettings::sky`] adds it
/// to cameras that have neither it nor Bevy's `Skybox`.
#[derive(Component, Clone, Copy, Debug, PartialEq, Reflect)]
#[reflect(Component, Default, Debug, PartialEq, Clone)]
pub struct Sky {
    /// The colour at the horizon.
    pub horizon: Color,
    /// The colour overhead.
    pub zenith: Color,
    /// The colour below the horizon.
    pub ground: Color,
}

impl Default for Sky {
    fn default() -> Self {
        Sky {
            horizon: Color::srgb_u8(0xd6, 0xe2, 0xec),
            zenith: Color::srgb_u8(0x5a, 0x93, 0xcc),
            ground: Color::srgb_u8(0xa2, 0xa6, 0xa4),
        }
    }
}

/// The number of pixels along the side of a face of the cube map.
const SIDE: u32 = 32;

impl Sky {
    /// Returns the colour in a direction whose component along +z is `up`.
    fn color(self, up: f32) -> LinearRgba {
        let [horizon, zenith, ground] =
            [self.horizon, self.zenith, self.ground].map(|color| color.to_linear());
        if up < 0.0 {
            return horizon.mix(&ground, (-12.0 * up).min(1.0));
        }
        horizon.mix(&zenith, up.sqrt())
    }

    /// Creates a cube map of the sky.
    fn image(self) -> Image {
        let mut data = Vec::new();
        for face in 0..6 {
            for row in 0..SIDE {
                for column in 0..SIDE {
                    let [u, v] = [column, row].map(|i| 2.0 * (i as f32 + 0.5) / SIDE as f32 - 1.0);
                    // The faces are +x, -x, +y, -y, +z, -z of a left-handed cube, which Bevy samples with -z.
                    let direction = match face {
                        0 => Vec3::new(1.0, -v, -u),
                        1 => Vec3::new(-1.0, -v, u),
                        2 => Vec3::new(u, 1.0, v),
                        3 => Vec3::new(u, -1.0, -v),
                        4 => Vec3::new(u, -v, 1.0),
                        _ => Vec3::new(-u, -v, -1.0),
                    };
                    let up = -direction.normalize().z;
                    data.extend(Srgba::from(self.color(up)).to_u8_array());
                }
            }
        }
        let size = Extent3d { width: SIDE, height: SIDE, depth_or_array_layers: 6 };
        let format = TextureFormat::Rgba8UnormSrgb;
        let usage = RenderAssetUsages::RENDER_WORLD;
        let mut image = Image::new(size, TextureDimension::D2, data, format, usage);
        image.texture_view_descriptor = Some(TextureViewDescriptor {
            dimension: Some(TextureViewDimension::Cube),
            ..default()
        });
        image.sampler = bevy::image::ImageSampler::linear();
        image
    }
}

/// A marker component of a camera whose sky was added because of the settings.
#[derive(Component, Clone, Copy)]
pub(super) struct GivenSky;

/// A component with the image of a sky.
#[derive(Component, Clone)]
pub(super) struct DrawnSky(Handle<Image>);

/// A filter for cameras without a sky, to which none was added before.
type Bare = (With<Camera3d>, Without<Sky>, Without<Skybox>, Without<GivenSky>);

/// A filter for cameras whose sky is new or has changed. The sky may be older than the camera.
type Renewed = (With<Camera3d>, Or<(Changed<Sky>, Added<Camera3d>)>);

/// Removes the skies that were added to cameras, once the settings no longer ask for them.
pub(super) fn take_skies(
    settings: Res<Visuals3dSettings>,
    given: Query<(Entity, &Sky), With<GivenSky>>,
    mut commands: Commands,
) {
    // A sky that the app has changed is kept.
    for (camera, _) in given.iter().filter(|(_, sky)| !settings.sky && **sky == Sky::default()) {
        commands.entity(camera).try_remove::<(Sky, GivenSky)>();
    }
}

/// Adds a sky to cameras if the settings ask for it, and draws new and changed skies.
pub(super) fn add_skies(
    settings: Res<Visuals3dSettings>,
    bare: Query<Entity, Bare>,
    changed: Query<(Entity, &Sky), Renewed>,
    images: Option<ResMut<Assets<Image>>>,
    mut brightness: Local<Option<u32>>,
    mut skies: Query<(&mut Skybox, &DrawnSky), With<Sky>>,
    mut commands: Commands,
) {
    let Some(mut images) = images else { return };
    // By its bits, since a NaN does not equal itself.
    let wanted = settings.brightness.to_bits();
    if brightness.replace(wanted) != Some(wanted) {
        // A skybox that the app has replaced is kept.
        let drawn = |(skybox, drawn): &(Mut<'_, Skybox>, &DrawnSky)| {
            skybox.image.as_ref() == Some(&drawn.0)
        };
        for (mut skybox, _) in skies.iter_mut().filter(drawn) {
            skybox.brightness = INTENSITY * settings.brightness;
        }
    }
    if settings.sky {
        for camera in &bare {
            commands.entity(camera).try_insert((Sky::default(), GivenSky));
        }
    }
    for (camera, sky) in &changed {
        let image = images.add(sky.image());
        let skybox = Skybox {
            image: Some(image.clone()),
            brightness: INTENSITY * settings.brightness,
            ..default()
        };
        commands.entity(camera).try_insert((skybox, DrawnSky(image)));
    }
}

/// Removes the skybox of a sky that is removed, unless the app has replaced the skybox.
pub(super) fn remove_skybox(
    removed: On<Remove, Sky>,
    cameras: Query<(&Skybox, &DrawnSky)>,
    mut commands: Commands,
) {
    if let Ok((skybox, drawn)) = cameras.get(removed.entity)
        && skybox.image.as_ref() == Some(&drawn.0)
    {
        commands.entity(removed.entity).try_remove::<(Skybox, DrawnSky)>();
    }
}
