//! Pictures in apps that compile pipelines in the background, as apps with a window do.

use std::path::PathBuf;
use std::time::Duration;

use bevy::app::PluginsState;
use bevy::camera::{CameraPlugin, RenderTarget};
use bevy::core_pipeline::CorePipelinePlugin;
use bevy::diagnostic::FrameCountPlugin;
use bevy::mesh::MeshPlugin;
use bevy::prelude::*;
use bevy::render::RenderPlugin;
use bevy::sprite::SpritePlugin;
use bevy::sprite_render::SpriteRenderPlugin;
use bevy::time::TimePlugin;
use bevy::window::{ExitCondition, WindowPlugin};
use bevy_offscreen::{CapturePlugin, PictureTaken, TakePicture};
use wgpu_types::TextureFormat;

/// A resource with the files of pictures that were taken.
#[derive(Resource, Default)]
struct Taken(Vec<PathBuf>);

fn app() -> App {
    let mut app = App::new();
    let (primary_window, exit_condition) = (None, ExitCondition::DontExit);
    app.add_plugins((
        TaskPoolPlugin::default(),
        FrameCountPlugin,
        TimePlugin,
        TransformPlugin,
        bevy::input::InputPlugin,
        WindowPlugin { primary_window, exit_condition, ..default() },
        AssetPlugin::default(),
        RenderPlugin::default(),
        ImagePlugin::default(),
        MeshPlugin,
        CameraPlugin,
        CorePipelinePlugin,
        SpritePlugin,
        SpriteRenderPlugin,
    ));
    app.add_plugins(CapturePlugin).init_resource::<Taken>();
    app.add_observer(|taken: On<PictureTaken>, mut all: ResMut<Taken>| {
        all.0.push(taken.path.clone());
    });
    while app.plugins_state() == PluginsState::Adding {
        bevy::tasks::tick_global_task_pools_on_main_thread();
    }
    app.finish();
    app.cleanup();
    app
}

fn picture(app: &mut App, camera: Entity, path: PathBuf) -> Vec<u8> {
    app.world_mut().trigger(TakePicture { entity: camera, path: path.clone() });
    for _ in 0..1000 {
        app.update();
        if app.world().resource::<Taken>().0.contains(&path) {
            let file = std::io::BufReader::new(std::fs::File::open(&path).unwrap());
            let mut reader = png::Decoder::new(file).read_info().unwrap();
            let mut pixels = vec![0; reader.output_buffer_size().unwrap()];
            reader.next_frame(&mut pixels).unwrap();
            return pixels;
        }
        std::thread::sleep(Duration::from_millis(5));
    }
    panic!("no picture is taken");
}

#[test]
fn the_first_picture_of_a_camera_lacks_nothing() {
    let folder = tempfile::tempdir().unwrap();
    for is_active in [false, true] {
        let mut app = app();
        let red = Color::srgb(1.0, 0.0, 0.0);
        app.world_mut().spawn(Sprite::from_color(red, Vec2::splat(1000.0)));
        let image = Image::new_target_texture(32, 24, TextureFormat::Rgba8UnormSrgb, None);
        let image = app.world_mut().resource_mut::<Assets<Image>>().add(image);
        let camera = Camera { is_active, ..default() };
        let camera = (Camera2d, camera, RenderTarget::Image(image.into()));
        let camera = app.world_mut().spawn(camera).id();
        let pixels = picture(&mut app, camera, folder.path().join(format!("{is_active}.png")));
        let is_red = |pixel: &[u8]| pixel[0] > 250 && pixel[1] < 5 && pixel[2] < 5;
        assert_eq!(pixels.len(), 3 * 32 * 24);
        assert!(pixels.chunks(3).all(is_red), "{:?}", &pixels[..3]);
        assert_eq!(app.world().get::<Camera>(camera).unwrap().is_active, is_active);
    }
}
