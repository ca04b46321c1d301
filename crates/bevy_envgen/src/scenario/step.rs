//! Advances the scenarios by a step, and updates their entities.

use bevy::prelude::*;

use super::ScenarioAgent;
use super::part::{Door, DoorChange, DoorChanged, DoorLeaf, Person, PersonReacted, Smoke};
use super::pose::{leaf_poses, person_pose};
use super::run::ScenarioRun;
use crate::place::propagated;
use crate::shape::LocalFrame;

/// A running scenario.
type Running = (Entity, &'static mut ScenarioRun);

/// Advances all scenarios by a step of the schedule.
pub(super) fn step(
    time: Res<Time>,
    mut runs: Query<Running>,
    agents: Query<&ScenarioAgent>,
    mut doors: Query<&mut Door>,
    places: Query<&Transform>,
    parents: Query<&ChildOf>,
) {
    for (entity, mut run) in &mut runs {
        let known = run.bypass_change_detection();
        // The positions of agents are current, so the frame must be current too.
        known.frame = propagated(entity, |at| places.get(at).ok(), |below| parents.get(below).ok());
        if known.is_paused() {
            continue;
        }
        for index in 0..known.doors.len() {
            let entity = known.doors[index].door;
            let command = doors.get(entity).ok().and_then(|door| door.command);
            if let (Some(command), Ok(mut door)) = (command, doors.get_mut(entity)) {
                door.command = None;
                // The door exists, so there is no error.
                known.command_door(index, command).ok();
            }
        }
        let affine = known.frame.affine().as_daffine3().inverse();
        let robots = agents.iter().filter_map(|agent| agent.robot(&affine, known.origin));
        let mut robots: Vec<_> = robots.collect();
        // The order of the query depends on the history of the app, so robots are sorted by position.
        robots.sort_by(|a, b| {
            let (p, q) = (a.position, b.position);
            p.x.total_cmp(&q.x).then(p.y.total_cmp(&q.y))
        });
        match known.advance(time.delta_secs_f64(), &robots) {
            Ok(true) => run.set_changed(),
            Ok(false) => {}
            Err(error) => log::warn!("scenario of environment {entity}: {error}"),
        }
    }
}

/// The components of a person that is updated.
type Placed = (&'static mut Person, &'static mut Transform, &'static mut GlobalTransform);

/// Moves people to their current poses, which physics may have changed, and updates smoke.
pub(super) fn place(
    runs: Query<&ScenarioRun>,
    mut people: Query<Placed, Without<ScenarioRun>>,
    mut smoke: Query<&mut Smoke>,
    mut reacted: MessageWriter<PersonReacted>,
    mut commands: Commands,
) {
    for run in &runs {
        let frame = LocalFrame::new(run.origin);
        for (&entity, now) in run.people.iter().zip(run.now().people()) {
            let Ok((mut person, mut at, mut above)) = people.get_mut(entity) else { continue };
            let place = person_pose(frame, now);
            at.set_if_neq(place);
            above.set_if_neq(run.frame.mul_transform(place));
            let (velocity, reacts) = (now.velocity.as_vec2(), now.is_reacting());
            if person.reacts != reacts {
                let event = PersonReacted { entity, begins: reacts };
                reacted.write(event);
                commands.trigger(event);
            }
            let next = Person { velocity, reacts, ..*person };
            person.set_if_neq(next);
        }
        for (&entity, (_, extinction)) in run.smoke.iter().zip(run.state.smoke()) {
            if let Ok(mut smoke) = smoke.get_mut(entity) {
                let next = Smoke { extinction, ..*smoke };
                smoke.set_if_neq(next);
            }
        }
    }
}

/// The components of a leaf that is updated.
type PlacedLeaf = (&'static mut DoorLeaf, &'static mut Transform, &'static mut GlobalTransform);

/// Moves leaves to their current poses, and reports changes of doors.
pub(super) fn place_leaves(
    runs: Query<&ScenarioRun>,
    mut doors: Query<&mut Door>,
    mut leaves: Query<PlacedLeaf, Without<ScenarioRun>>,
    mut changed: MessageWriter<DoorChanged>,
    mut commands: Commands,
) {
    for run in &runs {
        let frame = LocalFrame::new(run.origin);
        for (index, (known, now)) in run.doors.iter().zip(run.state.doors()).enumerate() {
            let Ok(mut door) = doors.get_mut(known.door) else { continue };
            // A long step may block a door and open it again.
            let blocked = (now.stopped > door.stopped).then_some(DoorChange::Blocked);
            let end = if now.opens { DoorChange::Opened } else { DoorChange::Closed };
            let moved = now.openness != door.openness || blocked.is_some();
            let ended = (now.is_still() && moved).then_some(end);
            for change in blocked.into_iter().chain(ended) {
                let event = DoorChanged { entity: known.door, change };
                changed.write(event);
                commands.trigger(event);
            }
            let next =
                Door { openness: now.openness, opens: now.opens, stopped: now.stopped, ..*door };
            door.set_if_neq(next);
            let there = leaf_poses(frame, &known.at, run.now(), index);
            for (&entity, (now, place)) in known.leaves.iter().zip(there) {
                let Ok((mut leaf, mut at, mut above)) = leaves.get_mut(entity) else { continue };
                leaf.set_if_neq(now);
                at.set_if_neq(place);
                above.set_if_neq(run.frame.mul_transform(known.at).mul_transform(place));
            }
        }
    }
}
