//! Three-dimensional meshes, materials, light and sky for the worlds of environments, and for the people,
//! doors and smoke of scenarios.
//!
//! The frame is that of the world with z up, and the floor is at z = 0; it is not converted to Bevy's y-up.
//! Meshes are those of [`envgen::mesh`] in single precision. Cameras must be oriented with
//! `looking_at(.., Vec3::Z)`.
//!
//! ```text
//! Environment
//!   Tile              a mesh for each Finish of its parts (Mesh3d, TileMesh); trees share the meshes of trunk
//!                     and crown, coarser ones far away
//!   Stage             ground around the world, the light that fills it, the sun
//!   Person, DoorLeaf  their meshes
//!   Smoke             boxes that hide what is in and behind them
//! ```

mod draft;
mod draw;
mod finish;
mod finish_material;
mod glow;
mod look;
mod marks;
mod moving;
mod palette;
mod settings;
mod sky;
mod smoke;
mod stage;
mod texture;
mod tile;
mod tree_levels;
mod trees;

use bevy::camera::visibility::VisibilitySystems;
use bevy::mesh::mark_3d_meshes_as_changed_if_their_assets_changed;
use bevy::prelude::*;
use bevy::transform::TransformSystems;

pub use finish::Finish;
pub use moving::Figure;
pub use palette::Palette3d;
pub use settings::Visuals3dSettings;
pub use sky::Sky;
pub use stage::{Stage, Sun};
pub use tile::TileMesh;

use crate::scenario::ScenarioSystems;
use crate::systems::{EnvgenSchedules, EnvgenSystems};
use crate::visuals::{FlatDrawing, require_visibility};

/// Draws worlds in three dimensions, for [`Camera3d`], with or without the plugin for two dimensions. Apart
/// from its trees, each tile has at most one mesh for each [`Finish`].
///
/// Adds the resources [`Visuals3dSettings`] and [`Palette3d`], unless the app already has them. It sets the
/// brightness of Bevy's `GlobalAmbientLight` to almost zero, since rooms have lamps and the open has a sky.
/// Needs Bevy's plugins for meshes, light and `StandardMaterial`s, which must be added before it, and draws
/// nothing without them.
#[derive(Clone, Debug, Default)]
pub struct EnvgenVisuals3dPlugin {
    settings: Option<Visuals3dSettings>,
}

impl EnvgenVisuals3dPlugin {
    /// Inserts `settings`, replacing those that the app already has.
    pub fn new(settings: Visuals3dSettings) -> Self {
        EnvgenVisuals3dPlugin { settings: Some(settings) }
    }
}

/// The brightness in cd/m² of the ambient light, so that dark rooms are not completely black.
const AMBIENT: f32 = 4.0;

impl Plugin for EnvgenVisuals3dPlugin {
    fn build(&self, app: &mut App) {
        match self.settings {
            Some(settings) => app.insert_resource(settings),
            None => app.init_resource::<Visuals3dSettings>(),
        };
        app.register_type::<Visuals3dSettings>()
            .register_type::<Palette3d>()
            .register_type::<Finish>()
            .register_type::<TileMesh>()
            .register_type::<Sky>()
            .register_type::<Stage>()
            .register_type::<Sun>()
            .init_resource::<Palette3d>()
            .insert_resource(GlobalAmbientLight { brightness: AMBIENT, ..default() })
            .init_resource::<finish_material::Finishes>()
            .init_resource::<trees::TreeMeshes>()
            .register_type::<Figure>()
            .register_type::<moving::FigureBody>()
            .init_resource::<moving::FigureMesh>()
            .init_resource::<moving::SharedLeafMesh>()
            .add_observer(draw::draw)
            .add_observer(moving::draw_person)
            .add_observer(moving::draw_figure)
            .add_observer(moving::draw_leaf)
            .add_observer(moving::remove_figure)
            .add_observer(sky::remove_skybox)
            .add_observer(smoke::draw_smoke);
        smoke::build(app);
        let main = EnvgenSchedules::of(app).main;
        app.add_systems(
            main,
            (
                stage::set_stage.run_if(finish_material::can_draw),
                stage::follow_anchors,
                stage::share_sun,
                tile::show_ceilings,
                moving::stretch_leaves,
                moving::remove_clones,
                sky::take_skies,
                sky::add_skies,
                smoke::thicken_smoke,
                smoke::measure_depths,
            )
                .chain()
                .after(EnvgenSystems::Notify)
                // An app may have scenarios in the same schedule.
                .after(ScenarioSystems)
                .after(FlatDrawing),
        )
        .add_systems(
            PostUpdate,
            tree_levels::choose_levels
                .after(TransformSystems::Propagate)
                // At that time the cameras of robots that take a picture are active.
                .after(VisibilitySystems::UpdateFrusta)
                .after(VisibilitySystems::CalculateBounds)
                .before(VisibilitySystems::CheckVisibility)
                // That system only marks meshes as changed.
                .ambiguous_with(mark_3d_meshes_as_changed_if_their_assets_changed),
        );
        require_visibility(app);
    }
}
