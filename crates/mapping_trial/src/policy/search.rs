//! Searches the costmap for optimal paths with Dijkstra's algorithm (1959), or with A* (Hart, Nilsson
//! and Raphael, 1968, <https://doi.org/10.1109/TSSC.1968.300136>) if there is one goal.

use glam::{DVec2, IVec2};

use super::costmap::{CellCost, Costmap, NODES, Node, SIDE, STEPS};

/// Cost per metre far from obstacles.
pub const COST_PER_METRE: u32 = (10.0 / SIDE) as u32;

/// Costs of a straight and of a diagonal step, by cell cost. In cells that its body does not fit into,
/// a robot may only drive out of them.
const COSTS: [[u32; 2]; 8] =
    [[10, 14], [14, 20], [22, 31], [36, 51], [100, 141], [100, 141], [100, 141], [u32::MAX; 2]];

/// Number of queues, which is more than the priority can rise in one step.
const QUEUES: usize = 256;

/// How far in metres a robot of the Pioneer's size may drive from its start where it does not fit.
const ESCAPE: f64 = 1.2;

/// Radius in metres around a robot of the Pioneer's size in which start cells are searched if its own
/// is occupied.
const BODY: f64 = 0.3;

/// A disc that paths avoid for some time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct KeepoutZone {
    /// Centre in metres in the map's frame.
    pub center: DVec2,
    /// Radius in metres.
    pub radius: f64,
}

/// A path planner on a costmap, with the state and the memory of its last search.
///
/// ```
/// use envgen::{Blueprint, Seed, Spec, glam::DVec2, hallway::HallwaySpec};
/// use mapping_trial::policy::costmap::Costmap;
/// use mapping_trial::policy::search::{COST_PER_METRE, GridPlanner};
/// use mapping_trial::{robot::Robot, mappable_area::MappableArea};
///
/// let world = HallwaySpec { segments: 3, ..Default::default() }.generate(Seed(7))?.to_world();
/// let area = MappableArea::new(&world, &Robot::default())?;
/// let mut costmap = Costmap::new(&Robot::default());
/// costmap.refresh(&area.perfect_map());
/// let (mut planner, start) = (GridPlanner::new(), area.start());
/// // Straight ahead 1 m: the hallway starts upwards.
/// let goal = start + DVec2::new(0.0, 1.0);
/// let node = planner.to(&mut costmap, start, &[], goal).expect("a free path");
/// assert_eq!(planner.cost(node), Some(COST_PER_METRE));
/// let mut points = Vec::new();
/// planner.path_to(&costmap, node, &mut points);
/// assert!(points[0].distance(start) < 0.1 && points.last().unwrap().distance(goal) < 0.1);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct GridPlanner {
    nodes: Vec<State>,
    /// For each tile, the search in which it was last used.
    used: Vec<u32>,
    search: u32,
    /// The worst cell cost on paths.
    worst_allowed: CellCost,
    queues: Vec<Vec<(Node, u32)>>,
    /// Start cells with their costs, by priority. Those of large robots are too far apart to enter the
    /// queues at once.
    seeds: Vec<(u32, Node, u32)>,
    /// [`ESCAPE`] for this robot, in planning cells.
    escape: i32,
}

#[derive(Clone, Copy, Debug)]
struct State {
    cost: u32,
    /// The direction of the step that led here; 8 at a start.
    from: u8,
    closed: bool,
}

const UNSEEN: State = State { cost: u32::MAX, from: START, closed: false };
const START: u8 = 8;

impl Default for GridPlanner {
    fn default() -> Self {
        GridPlanner {
            nodes: Vec::new(),
            used: Vec::new(),
            search: 0,
            worst_allowed: CellCost::Tight,
            queues: vec![Vec::new(); QUEUES],
            seeds: Vec::new(),
            escape: 0,
        }
    }
}

impl GridPlanner {
    /// Creates a planner that has not searched yet.
    pub fn new() -> Self {
        GridPlanner::default()
    }

    /// Limits paths to cells of this cost and better ones, from now on.
    pub fn set_worst_allowed(&mut self, worst_allowed: CellCost) {
        self.worst_allowed = worst_allowed;
    }

    /// Visits cells in ascending order of their cost from `start` until `done` returns true. Returns
    /// the last cell, or `None` if all cells that can be reached were visited.
    pub fn nearest(
        &mut self,
        costmap: &mut Costmap,
        start: DVec2,
        blocks: &[KeepoutZone],
        done: impl FnMut(Node, u32) -> bool,
    ) -> Option<Node> {
        self.run(costmap, start, blocks, |_| 0, done)
    }

    /// Returns the cheapest path to the planning cell that contains a point; `None` if there is no
    /// path.
    pub fn to(
        &mut self,
        costmap: &mut Costmap,
        start: DVec2,
        blocks: &[KeepoutZone],
        goal: DVec2,
    ) -> Option<Node> {
        let goal = costmap.node_at(goal)?;
        let place = costmap.place(goal);
        let left = |at: IVec2| {
            let offset = (at - place).abs();
            let (long, short) = (offset.max_element() as u32, offset.min_element() as u32);
            10 * (long - short) + 14 * short
        };
        self.run(costmap, start, blocks, left, |node, _| node == goal)
    }

    /// Writes the path to a node that the last search visited into `points`, from the start of the
    /// search. There are no points for other nodes, or before the first search.
    pub fn path_to(&self, costmap: &Costmap, to: Node, points: &mut Vec<DVec2>) {
        points.clear();
        if self.cost(to).is_none() {
            return;
        }
        let mut node = to;
        loop {
            points.push(costmap.point(node));
            let direction = self.nodes[node.0 as usize].from;
            if direction == START {
                break;
            }
            let Some(before) = costmap.step(node, usize::from(direction + 4) % 8) else { break };
            node = before;
        }
        points.reverse();
    }

    /// Returns the cost of a node that the last search visited.
    pub fn cost(&self, node: Node) -> Option<u32> {
        let seen = self.used.get(node.slot()) == Some(&self.search);
        seen.then(|| self.nodes[node.0 as usize].cost).filter(|&cost| cost != u32::MAX)
    }

    fn run(
        &mut self,
        costmap: &mut Costmap,
        start: DVec2,
        blocks: &[KeepoutZone],
        left: impl Fn(IVec2) -> u32,
        mut done: impl FnMut(Node, u32) -> bool,
    ) -> Option<Node> {
        self.begin(costmap.tiles());
        self.escape = in_cells(costmap.grown(ESCAPE));
        let middle = super::costmap::cell_of(start);
        for block in blocks {
            self.block(costmap, block, middle);
        }
        self.collect_seeds(costmap, start, &left);
        let mut waiting = self.seeds.len();
        let (mut priority, mut queued) = (self.seeds.first().map_or(0, |seed| seed.0), 0);
        // The queues hold the next QUEUES priorities in turn, since no step adds as many.
        while waiting > 0 {
            while let Some(&(of_seed, node, cost)) = self.seeds.get(queued)
                && of_seed < priority + QUEUES as u32
            {
                self.queues[of_seed as usize % QUEUES].push((node, cost));
                queued += 1;
            }
            let Some((node, cost)) = self.queues[priority as usize % QUEUES].pop() else {
                priority += 1;
                continue;
            };
            waiting -= 1;
            let state = &mut self.nodes[node.0 as usize];
            if state.closed || state.cost != cost {
                continue;
            }
            state.closed = true;
            if done(node, cost) {
                return Some(node);
            }
            waiting += self.expand(costmap, node, cost, middle, &left);
        }
        None
    }

    /// Begins a new search.
    fn begin(&mut self, tiles: usize) {
        self.search = self.search.wrapping_add(1);
        if self.search == 0 {
            self.used.fill(0);
            self.search = 1;
        }
        self.used.resize(tiles, 0);
        self.nodes.resize(tiles * NODES, UNSEEN);
        for queue in &mut self.queues {
            queue.clear();
        }
    }

    /// Prepares a tile for this search.
    #[inline]
    fn enter(&mut self, costmap: &mut Costmap, slot: usize) {
        if self.used[slot] != self.search {
            self.used[slot] = self.search;
            self.nodes[slot * NODES..(slot + 1) * NODES].fill(UNSEEN);
            costmap.derive_costs(slot);
        }
    }

    /// Closes the nodes of a keepout zone, except those around the start, since the robot has to get
    /// out.
    fn block(&mut self, costmap: &mut Costmap, block: &KeepoutZone, start: IVec2) {
        if !(block.radius.is_finite() && block.center.is_finite()) {
            return;
        }
        let reach = (block.radius.min(5.0) / SIDE).ceil() as i32;
        let middle = super::costmap::cell_of(block.center);
        for dy in -reach..=reach {
            for dx in -reach..=reach {
                let cell = middle.saturating_add(IVec2::new(dx, dy));
                let p = (cell.as_dvec2() + 0.5) * SIDE;
                let leave = (cell.wrapping_sub(start)).abs().max_element() <= 1;
                if leave || p.distance_squared(block.center) > block.radius * block.radius {
                    continue;
                }
                if let Some(node) = costmap.node_at(p) {
                    self.enter(costmap, node.slot());
                    self.nodes[node.0 as usize].closed = true;
                }
            }
        }
    }

    /// Collects the start cells: the cell that contains the start or, if the map shows it as occupied,
    /// the cells around it that are not.
    fn collect_seeds(&mut self, costmap: &mut Costmap, start: DVec2, left: impl Fn(IVec2) -> u32) {
        self.seeds.clear();
        let Some(node) = costmap.node_at(start) else { return };
        let body = in_cells(costmap.grown(BODY));
        let reach = if costmap.cell_cost(node) == CellCost::Occupied { body } else { 0 };
        for dy in -reach..=reach {
            for dx in -reach..=reach {
                let p = start + DVec2::new(f64::from(dx), f64::from(dy)) * SIDE;
                let Some(node) = costmap.node_at(p) else { continue };
                self.enter(costmap, node.slot());
                if costmap.derived_cell_cost(node) == CellCost::Occupied {
                    continue;
                }
                let cost = (dx * dx + dy * dy) as u32;
                self.nodes[node.0 as usize] = State { cost, from: START, closed: false };
                self.seeds.push((cost + left(costmap.place(node)), node, cost));
            }
        }
        self.seeds.sort_by_key(|&(priority, ..)| priority);
    }

    /// Puts a node's neighbours into the queues, and counts them.
    fn expand(
        &mut self,
        costmap: &mut Costmap,
        node: Node,
        cost: u32,
        start: IVec2,
        left: impl Fn(IVec2) -> u32,
    ) -> usize {
        let inside = costmap.derived_cell_cost(node) <= self.worst_allowed;
        let mut added = 0;
        let is_within_tile = node.is_within_tile();
        for direction in 0..STEPS.len() {
            // Most neighbours are in the tile of the node, which is already prepared.
            let next = if is_within_tile {
                node.beside(direction)
            } else {
                let Some(next) = costmap.step(node, direction) else { continue };
                self.enter(costmap, next.slot());
                next
            };
            let state = self.nodes[next.0 as usize];
            if state.closed {
                continue;
            }
            let cell_cost = costmap.derived_cell_cost(next);
            let fits = cell_cost <= self.worst_allowed;
            if !fits || !inside {
                // A robot that does not fit where it is may drive until it fits, but not far, not
                // between two occupied cells, and never from where it fits to where it does not.
                if cell_cost == CellCost::Occupied
                    || (inside && !fits)
                    || (costmap.place(next) - start).abs().max_element() > self.escape
                    || (direction % 2 == 1 && self.squeezes(costmap, node, direction))
                {
                    continue;
                }
            }
            let through = cost + COSTS[cell_cost as usize][direction % 2];
            if through < state.cost {
                self.nodes[next.0 as usize] =
                    State { cost: through, from: direction as u8, closed: false };
                let priority = through + left(costmap.place(next));
                self.queues[priority as usize % QUEUES].push((next, through));
                added += 1;
            }
        }
        added
    }

    /// Whether one of the two cells beside a diagonal step is occupied.
    fn squeezes(&mut self, costmap: &mut Costmap, node: Node, direction: usize) -> bool {
        [direction - 1, (direction + 1) % 8].into_iter().any(|side| {
            costmap
                .step(node, side)
                .is_none_or(|node| costmap.cell_cost(node) == CellCost::Occupied)
        })
    }
}

/// Converts a distance to the nearest number of planning cells, at least one.
fn in_cells(distance: f64) -> i32 {
    ((distance / SIDE).round() as i32).max(1)
}
