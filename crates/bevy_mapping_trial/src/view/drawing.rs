//! The drawing of one trial, and its updates.

use bevy::camera::visibility::{NoFrustumCulling, RenderLayers};
use bevy::ecs::system::SystemParam;
use bevy::prelude::*;
use bevy::sprite_render::AlphaMode2d;
use envgen::geometry::Pose;
use envgen::glam::DVec2;
use mapping_trial::backend::RobotBackend;
use mapping_trial::slam::SlamKind;
use mapping_trial::trial::Trial;

use super::camera::MapMark;
use super::map::{self, Paint, Sheets};
use super::minimap::MINIMAP_LAYER;
use super::palette::TrialPalette;
use super::trail::Trail;
use super::trial_view::TrialView;
use super::{scan, shape};

/// The height of the view above everything that is drawn of worlds.
const ABOVE: f32 = 0.5;

/// The heights of the layers within the view.
const TRUE_TRAIL: f32 = 0.01;
const TRAIL: f32 = 0.02;
const SCAN: f32 = 0.03;
const TRUE_BODY: f32 = 0.04;
const BODY: f32 = 0.05;
const MARK: f32 = 0.06;

/// The opacity of the map when it is drawn over the true world.
const MAP_OVER_TRUTH: f32 = 0.6;

/// The number of ticks between two checks of whether loop closing has changed the past trajectory.
const RENEWAL: usize = 40;

/// The system parameters that drawings need. The assets are missing in apps that do not draw.
#[derive(SystemParam)]
pub(super) struct Canvas<'w, 's> {
    pub(super) commands: Commands<'w, 's>,
    pub(super) images: Option<ResMut<'w, Assets<Image>>>,
    pub(super) meshes: Option<ResMut<'w, Assets<Mesh>>>,
    pub(super) materials: Option<ResMut<'w, Assets<ColorMaterial>>>,
    pub(super) places: Query<'w, 's, &'static mut Transform>,
    pub(super) groups: Query<'w, 's, &'static mut Visibility>,
    pub(super) sprites: Query<'w, 's, &'static mut Sprite>,
}

/// A marker component of the parent of everything that is drawn of a trial. Clones and scenes hold it, so
/// that the drawings that they contain can be found.
#[derive(Component, Clone, Copy, Debug, Default, PartialEq, Eq, Reflect)]
#[reflect(Component, Default, Debug, PartialEq, Clone)]
pub(super) struct DrawingRoot;

/// A component with the drawing of a trial, on the entity of its environment.
#[derive(Component)]
pub(super) struct Drawing {
    /// The parent of everything that is drawn.
    pub(super) root: Entity,
    maps: Entity,
    scans: Entity,
    trails: Entity,
    truths: Entity,
    sheets: Sheets,
    robots: Vec<Drawn>,
    /// The opacity of the sheets of the map.
    opacity: f32,
}

/// The drawing of one robot.
struct Drawn {
    body: Entity,
    mark: Entity,
    true_body: Entity,
    fan: Entity,
    fan_mesh: Handle<Mesh>,
    ranges: Vec<f64>,
    /// The tick of the scan that is drawn.
    scanned: Option<usize>,
    trail: Trail,
    trail_ink: Handle<ColorMaterial>,
    true_trail: Trail,
    true_ink: Handle<ColorMaterial>,
    /// The number of true poses that are drawn.
    tracked: usize,
    /// The tick at which the trail was last redrawn from its beginning.
    renewed: Option<usize>,
}

/// Spawns an entity below a parent. If the parent is despawned in the same frame, so is the entity, which
/// would stay without a parent.
fn spawn_below(commands: &mut Commands<'_, '_>, parent: Entity, parts: impl Bundle) -> Entity {
    let entity = commands.spawn_empty().id();
    commands.queue(move |world: &mut World| {
        if world.get_entity(parent).is_err() {
            world.despawn(entity);
        } else if let Ok(mut entity) = world.get_entity_mut(entity) {
            entity.insert((parts, ChildOf(parent)));
        }
    });
    entity
}

/// Returns a pose as a transform in the frame of the environment.
pub(super) fn place(pose: Pose, origin: DVec2, height: f32) -> Transform {
    let at = (pose.position - origin).as_vec2().extend(height);
    let rotation = Quat::from_rotation_z(pose.heading as f32);
    Transform { translation: at, rotation, scale: Vec3::ONE }
}

impl Drawing {
    /// Spawns the permanent parts of the drawing. Returns `None` if the app does not draw.
    pub(super) fn begin<B: RobotBackend>(
        environment: Entity,
        trial: &Trial<B>,
        palette: &TrialPalette,
        canvas: &mut Canvas<'_, '_>,
    ) -> Option<Drawing> {
        let (Some(meshes), Some(materials), Some(_)) =
            (&mut canvas.meshes, &mut canvas.materials, &canvas.images)
        else {
            return None;
        };
        let commands = &mut canvas.commands;
        let settings = trial.settings();
        let body = meshes.add(shape::body(&settings.body));
        let outline = meshes.add(shape::outline(&settings.body));
        let arrow = meshes.add(shape::mark());
        let true_ink = materials.add(palette.truth);
        let mut group = |name: &'static str, parent: Entity, height: f32| {
            let at = Transform::from_xyz(0.0, 0.0, height);
            spawn_below(commands, parent, (Name::new(name), at, Visibility::default()))
        };
        let root = group("trial view", environment, ABOVE);
        let maps = group("map", root, 0.0);
        let scans = group("scans", root, 0.0);
        let trails = group("paths", root, 0.0);
        let truths = group("truth", root, 0.0);
        commands.entity(root).try_insert(DrawingRoot);
        let robots = (0..trial.robots()).map(|robot| {
            let color = palette.robot(robot);
            let ink = materials.add(color);
            let light =
                ColorMaterial { alpha_mode: AlphaMode2d::Blend, ..ColorMaterial::from(color) };
            let light = materials.add(light);
            let fan_mesh = meshes.add(scan::fan(&settings.laser));
            let mut part =
                |name: &str, mesh: &Handle<Mesh>, ink: &Handle<ColorMaterial>, parent| {
                    let name = Name::new(format!("{name} {robot}"));
                    let look = (Mesh2d(mesh.clone()), MeshMaterial2d(ink.clone()));
                    // Meshes that change would need new bounds each time, and the other meshes are few.
                    spawn_below(commands, parent, (name, look, NoFrustumCulling))
                };
            let body = part("robot", &body, &ink, root);
            let mark = part("mark of robot", &arrow, &ink, body);
            let drawn = Drawn {
                body,
                mark,
                true_body: part("true robot", &outline, &true_ink, truths),
                fan: part("scan", &fan_mesh, &light, scans),
                fan_mesh,
                ranges: Vec::with_capacity(settings.laser.beams as usize),
                scanned: None,
                trail: Trail::default(),
                trail_ink: ink.clone(),
                true_trail: Trail::default(),
                true_ink: true_ink.clone(),
                tracked: 0,
                renewed: None,
            };
            let above = Transform::from_xyz(0.0, 0.0, MARK - BODY);
            let of = MapMark { trial: environment };
            commands.entity(mark).try_insert((of, above, RenderLayers::layer(MINIMAP_LAYER)));
            drawn
        });
        let robots = robots.collect();
        let sheets = Sheets::default();
        Some(Drawing { root, maps, scans, trails, truths, sheets, robots, opacity: 1.0 })
    }

    /// Draws what has changed in a trial since the last call.
    pub(super) fn renew<B: RobotBackend>(
        &mut self,
        trial: &Trial<B>,
        view: &TrialView,
        origin: DVec2,
        palette: &TrialPalette,
        canvas: &mut Canvas<'_, '_>,
    ) {
        self.show(view, canvas);
        self.renew_map(trial, origin, palette, canvas);
        let drawn = Drawn::renew;
        for robot in 0..self.robots.len().min(trial.robots()) {
            drawn(
                &mut self.robots[robot],
                robot,
                (self.trails, self.truths),
                trial,
                origin,
                canvas,
            );
        }
    }

    /// Shows and hides layers as `view` says.
    fn show(&mut self, view: &TrialView, canvas: &mut Canvas<'_, '_>) {
        let switches = [
            (self.maps, view.map),
            (self.scans, view.scan),
            (self.trails, view.path),
            (self.truths, view.truth),
        ];
        for (group, shown) in switches {
            let wanted = if shown { Visibility::Inherited } else { Visibility::Hidden };
            if let Ok(mut visibility) = canvas.groups.get_mut(group) {
                visibility.set_if_neq(wanted);
            } else {
                // The group was spawned in this frame, in which the true poses must be hidden as well.
                canvas.commands.entity(group).try_insert(wanted);
            }
        }
        let opacity = if view.truth { MAP_OVER_TRUTH } else { 1.0 };
        if self.opacity != opacity {
            self.opacity = opacity;
            for sheet in self.sheets.iter() {
                if let Ok(mut sprite) = canvas.sprites.get_mut(sheet.entity) {
                    sprite.color.set_alpha(opacity);
                }
            }
        }
    }

    fn renew_map<B: RobotBackend>(
        &mut self,
        trial: &Trial<B>,
        origin: DVec2,
        palette: &TrialPalette,
        canvas: &mut Canvas<'_, '_>,
    ) {
        let Some(images) = &mut canvas.images else { return };
        let (commands, maps, opacity) = (&mut canvas.commands, self.maps, self.opacity);
        let paint = Paint::new(palette.free, palette.occupied);
        self.sheets.renew(trial.autonomy().slam().map(), paint, images, |at, image| {
            let middle = (map::centre(at) - origin).as_vec2().extend(0.0);
            let sprite = Sprite {
                image,
                custom_size: Some(Vec2::splat(map::SHEET_SIDE as f32)),
                color: Color::WHITE.with_alpha(opacity),
                ..default()
            };
            let name = Name::new(format!("map ({}, {})", at.0, at.1));
            spawn_below(commands, maps, (name, sprite, Transform::from_translation(middle)))
        });
    }
}

impl Drawn {
    fn renew<B: RobotBackend>(
        &mut self,
        robot: usize,
        (trails, truths): (Entity, Entity),
        trial: &Trial<B>,
        origin: DVec2,
        canvas: &mut Canvas<'_, '_>,
    ) {
        let track = &trial.trajectory(robot).poses;
        let tick = track.len();
        let estimate = trial.autonomy().slam().estimate(robot).pose;
        let Some(meshes) = &mut canvas.meshes else { return };
        let mut put = |entity, at: Transform| {
            if let Ok(mut place) = canvas.places.get_mut(entity) {
                place.set_if_neq(at);
            } else {
                // The entity was spawned in this frame.
                canvas.commands.entity(entity).try_insert(at);
            }
        };
        put(self.body, place(estimate, origin, BODY));
        if let Some(&truth) = track.last() {
            put(self.true_body, place(truth, origin, TRUE_BODY));
        }

        // A scan is drawn where it was taken, even if the robot has moved since.
        let (scan, laser) = (trial.autonomy().scan(robot), &trial.settings().laser);
        let same = |(a, b): (&f64, &f64)| a.to_bits() == b.to_bits();
        let seen = self.ranges.len() == scan.ranges.len()
            && self.ranges.iter().zip(&scan.ranges).all(same)
            && self.scanned.is_some_and(|then| tick < then + laser.ticks_a_scan as usize);
        if !seen {
            self.ranges.clone_from(&scan.ranges);
            self.scanned = Some(tick);
            let from = trial.settings().body.laser_pose(estimate);
            put(self.fan, place(from, origin, SCAN));
            if let Some(mut mesh) = meshes.get_mut(&self.fan_mesh) {
                scan::spread(&mut mesh, laser, scan);
            }
        }

        let commands = &mut canvas.commands;
        let mut ribbon = |ink: &Handle<ColorMaterial>, parent, height, mesh| {
            let look = (Mesh2d(mesh), MeshMaterial2d(ink.clone()));
            let at = Transform::from_xyz(0.0, 0.0, height);
            spawn_below(commands, parent, (Name::new("path"), look, at, NoFrustumCulling))
        };
        let at = |p: DVec2| (p - origin).as_vec2();
        for pose in track.get(self.tracked..).unwrap_or_default() {
            self.true_trail.extend(at(pose.position), meshes, |mesh| {
                ribbon(&self.true_ink, truths, TRUE_TRAIL, mesh)
            });
        }
        let missed = tick - self.tracked.min(tick);
        self.tracked = tick;
        let mut trail = |trail: &mut Trail, meshes: &mut Assets<Mesh>, p: DVec2| {
            trail.extend(at(p), meshes, |mesh| ribbon(&self.trail_ink, trails, TRAIL, mesh));
        };
        // Loop closing changes past poses, and skipping several ticks at once leaves gaps.
        let changes = trial.settings().slam == SlamKind::PoseGraph && missed > 0;
        let due = self.renewed.is_none_or(|then| changes && tick >= then + RENEWAL);
        if due || missed > RENEWAL {
            self.renewed = Some(tick);
            self.trail.clear(meshes);
            for pose in trial.autonomy().slam().trajectory(robot) {
                trail(&mut self.trail, meshes, pose.position);
            }
        }
        if missed > 0 {
            trail(&mut self.trail, meshes, estimate.position);
        }
    }

    /// Returns the number of ticks of the trial that are drawn.
    pub(super) fn ticks(&self) -> usize {
        self.tracked
    }
}

impl Drawing {
    /// Returns whether none of its entities is missing. An app may despawn them together with others, such as
    /// all children of the environment.
    pub(super) fn is_whole(&self, canvas: &Canvas<'_, '_>) -> bool {
        let groups = [self.root, self.maps, self.scans, self.trails, self.truths];
        let robots = self.robots.iter().flat_map(|robot| {
            let trails = robot.trail.entities().chain(robot.true_trail.entities());
            [robot.body, robot.mark, robot.true_body, robot.fan].into_iter().chain(trails)
        });
        let sheets = self.sheets.iter().map(|sheet| sheet.entity);
        let mut all = groups.into_iter().chain(robots).chain(sheets);
        all.all(|entity| canvas.places.contains(entity))
    }

    /// Returns whether the trial is a continuation of the drawn one. Another trial of the same environment
    /// begins with fewer ticks.
    pub(super) fn is_of<B: RobotBackend>(&self, trial: &Trial<B>) -> bool {
        self.robots.len() == trial.robots()
            && (0..)
                .zip(&self.robots)
                .all(|(robot, drawn)| drawn.ticks() <= trial.trajectory(robot).poses.len())
    }
}
