//! Loop closing: finds keyframes that see a place from long before.

use std::f64::consts::PI;

use envgen::geometry::{Pose, wrap_angle};

use super::likelihood::LikelihoodField;
use super::mapper::{Keyframe, stamp};
use super::matcher::{Matcher, Window};
use super::pose_graph_solver::{Relation, held_by_walls};
use super::sweep::FEWEST_ECHOES;
use super::walls::{WALL_VARIANCE, WallPiece, walls};

/// Least path length in metres since a place was seen for it to count as old.
const OLDER: f64 = 10.0;

/// Distance in metres within which old places are searched: a constant, and a term per metre of path
/// since then, up to the window that is searched.
const NEAR: (f64, f64) = (3.0, 0.02);

/// Greatest difference of headings of two keyframes that see enough of the same, as a fraction of the
/// laser's field of view: two thirds of what they see is common.
const COMMON_VIEW: f64 = 1.0 / 3.0;

/// Field of view in radians from which two keyframes see that much of the same, whatever their
/// headings.
const ALL_AROUND: f64 = 1.5 * PI;

/// Distance in metres that counts as much as one radian between headings, in the choice of the old
/// keyframe that sees most of the same.
const TURN_COUNTS: f64 = 0.5;

/// Number of keyframes in the local map of an old place.
const CHAIN: usize = 10;

/// Half the side of the window in metres, and the largest difference of headings, in which a scan is
/// searched.
const REACH: (f64, f64) = (4.0, 20.0 * PI / 180.0);

/// Margin of the window, in metres and radians, in which no match is accepted.
const EDGE: (f64, f64) = (0.1, 1.0 * PI / 180.0);

/// Greatest distance of a match from the estimated pose, in metres and in standard deviations.
const CREDIBLE: (f64, f64) = (0.5, 4.0);

/// Least standard deviation in metres with which an old place is expected.
const LEAST_DEVIATION: f64 = 0.2;

/// Mean likelihood that a match has to reach.
const RESPONSE: f64 = 0.45;

/// Half the side in metres of the window around the estimated pose, and the difference of headings in
/// radians, in which a scan that fits almost as well shows that there is no error to correct.
const HERE: (f64, f64) = (0.6, 4.0 * PI / 180.0);

/// Greatest distance in metres of a match from the estimated pose for which nothing is to be corrected.
const NO_SHIFT: f64 = 0.1;

/// Distance in metres from the best match from which another place may look like it.
const ELSEWHERE: f64 = 0.6;

/// How much the mean likelihood of the best match has to exceed that of another place.
const DISTINCT: f64 = 0.1;

/// Least number of matches in a row that have to agree, and the path length in metres that they have to
/// span. Places that look alike from one position differ from the next.
const AGREEING: (usize, f64) = (3, 1.0);

/// Greatest distance in metres, and greatest difference of headings in radians, of two matches in a row
/// that agree.
const AGREEMENT: (f64, f64) = (0.2, 3.0 * PI / 180.0);

/// Path length in metres from one attempt to the next, and from a closed loop to the next attempt.
const PAUSE: (f64, f64) = (1.0, 3.0);

/// Levels of the fields of local maps.
const BLOCKS: [i32; 3] = [1, 4, 16];

/// Looks for closed loops, for all robots of a map.
#[derive(Clone, Debug)]
pub(crate) struct LoopCloser {
    field: LikelihoodField,
    matcher: Matcher,
    /// For searches around the estimated pose.
    near: Matcher,
    /// Largest difference of headings of keyframes that can be matched.
    most_turn: f64,
    robots: Vec<Progress>,
}

/// The state of the search for one robot.
#[derive(Clone, Debug, Default)]
struct Progress {
    /// The keyframes of this robot.
    chain: Vec<usize>,
    /// Path length at which the next attempt is due.
    due: f64,
    /// Matches in a row that agree and wait for more.
    pending: Vec<Seen>,
}

/// A keyframe that was found at an old place.
#[derive(Clone, Debug)]
struct Seen {
    keyframe: usize,
    old: usize,
    /// Its pose relative to the old one, since another robot's loop may move both.
    measured: Pose,
    walls: Vec<WallPiece>,
}

/// A closed loop.
#[derive(Clone, Debug)]
pub(crate) struct Closed {
    /// Two keyframes relative to the old place, the newer last.
    pub(crate) relations: [Relation; 2],
    /// The walls that hold the newer one.
    pub(crate) walls: Vec<WallPiece>,
}

impl LoopCloser {
    pub(crate) fn new(robots: usize, field_of_view: f64) -> Self {
        LoopCloser {
            field: LikelihoodField::new(&BLOCKS),
            matcher: Matcher::new(),
            near: Matcher::new(),
            most_turn: if field_of_view >= ALL_AROUND - 1e-9 {
                PI
            } else {
                COMMON_VIEW * field_of_view
            },
            robots: vec![Progress::default(); robots],
        }
    }

    /// Processes the newest keyframe. If several in a row are found at an old place, in agreement, the
    /// first and the last of them give the relations of a closed loop.
    pub(crate) fn take(&mut self, keyframes: &[Keyframe]) -> Option<Closed> {
        let newest = keyframes.len().checked_sub(1)?;
        let Keyframe { robot, path, .. } = keyframes[newest];
        self.robots[robot].chain.push(newest);
        if path < self.robots[robot].due {
            return None;
        }
        let mut pending = std::mem::take(&mut self.robots[robot].pending);
        let found = self.old_place(keyframes, newest).and_then(|old| {
            let pose = self.find(keyframes, newest, old)?;
            let walls = walls(&self.field, pose, &keyframes[newest].sweep.echoes);
            let measured = keyframes[old].pose.between(pose);
            Some(Seen { keyframe: newest, old, measured, walls })
        });
        let Some(seen) = found else {
            self.robots[robot].due = path + PAUSE.0;
            return None;
        };
        if pending.last().is_some_and(|before| !agree(keyframes, before, &seen)) {
            pending.clear();
        }
        pending.push(seen);
        let span = path - keyframes[pending[0].keyframe].path;
        if pending.len() < AGREEING.0 || span < AGREEING.1 {
            // The next keyframe is tried at once.
            self.robots[robot].pending = pending;
            return None;
        }
        self.robots[robot].due = path + PAUSE.1;
        let (first, last) = (&pending[0], pending.last()?);
        let relations = [first, last].map(relation);
        Some(Closed { relations, walls: last.walls.clone() })
    }

    /// Returns the old keyframe that sees most of what a new one sees, by its position and heading.
    fn old_place(&self, keyframes: &[Keyframe], newest: usize) -> Option<usize> {
        let new = &keyframes[newest];
        let mut best = None;
        // What is behind a robot's first keyframes was never seen.
        let is_seen = |i: usize| {
            let chain = &self.robots[keyframes[i].robot].chain;
            chain.get(CHAIN / 2).is_some_and(|&first| first <= i)
        };
        for (i, old) in keyframes[..newest].iter().enumerate() {
            // The path from one to the other: through the known starts for two robots.
            let path =
                if old.robot == new.robot { new.path - old.path } else { new.path + old.path };
            let distance = new.pose.position.distance(old.pose.position);
            if path >= OLDER && distance <= (NEAR.0 + NEAR.1 * path).min(REACH.0) {
                let turn = wrap_angle(new.pose.heading - old.pose.heading).abs();
                let rank = distance + TURN_COUNTS * turn;
                if turn <= self.most_turn && best.is_none_or(|(least, _)| rank < least) {
                    best = Some((rank, i));
                }
            }
        }
        best.map(|(_, i)| i).filter(|&i| is_seen(i))
    }

    /// Matches a keyframe's scan with the local map around an old one.
    fn find(&mut self, keyframes: &[Keyframe], newest: usize, old: usize) -> Option<Pose> {
        let new = &keyframes[newest];
        if new.sweep.echoes.len() < FEWEST_ECHOES {
            return None;
        }
        // Places look alike: of two similar ones, prefer the one nearer to the estimated pose.
        let variance = new.variance.position + keyframes[old].variance.position;
        let deviation = variance.sqrt().clamp(LEAST_DEVIATION, REACH.0 / 3.0);
        let heading_deviation = REACH.1 / 3.0;
        let window = Window {
            centre: new.pose,
            deviation,
            heading_deviation,
            reach: REACH.0,
            heading_reach: REACH.1,
        };
        self.field.reset(new.pose.position, Matcher::radius(new.sweep.radius(), &window));
        let chain = &self.robots[keyframes[old].robot].chain;
        let middle = chain.partition_point(|&i| i < old);
        let first = middle.saturating_sub(CHAIN / 2);
        for &i in chain[first..].iter().take(CHAIN).filter(|&&i| i != newest) {
            stamp(&mut self.field, keyframes[i].pose, &keyframes[i].sweep.echoes);
        }
        let echoes = &new.sweep.echoes;
        let mut search = self.matcher.search(&self.field, echoes, window)?;
        let found = search.find()?;
        // A match at the window's edge does not count, since the best one may be outside. Nor does one
        // that is farther off than the robot can be: places look alike.
        let shift = found.pose.position - new.pose.position;
        let turn = wrap_angle(found.pose.heading - new.pose.heading).abs();
        let inside = shift.abs().max_element() < REACH.0 - EDGE.0
            && turn < REACH.1 - EDGE.1
            && shift.length() <= CREDIBLE.0 + CREDIBLE.1 * variance.sqrt();
        if !inside || found.response < RESPONSE {
            return None;
        }
        let here = Window { reach: HERE.0, heading_reach: HERE.1, ..window };
        if let Some(here) = self.near.find(&self.field, echoes, here)
            && here.response >= (found.response - DISTINCT).max(RESPONSE)
        {
            let shift = here.pose.position.distance(new.pose.position);
            return (shift > NO_SHIFT).then_some(here.pose);
        }
        let apart = (found.pose.position, ELSEWHERE);
        let rival = search.rival(apart);
        rival.is_none_or(|rival| rival < found.response - DISTINCT).then_some(found.pose)
    }
}

/// Whether two matches agree with the robot's motion between them.
fn agree(keyframes: &[Keyframe], a: &Seen, b: &Seen) -> bool {
    let went = keyframes[a.keyframe].pose.between(keyframes[b.keyframe].pose);
    let at = |seen: &Seen| keyframes[seen.old].pose.compose(seen.measured);
    let found = at(a).between(at(b));
    went.position.distance(found.position) <= AGREEMENT.0
        && wrap_angle(went.heading - found.heading).abs() <= AGREEMENT.1
}

/// The relation of a match: much information across the walls that the scan saw, none along a bare
/// corridor.
fn relation(seen: &Seen) -> Relation {
    Relation {
        from: seen.old,
        to: seen.keyframe,
        measured: seen.measured,
        information: held_by_walls(seen.measured, &seen.walls, WALL_VARIANCE),
        is_robust: true,
    }
}
