//! The tools of the pointer on the plan.

use envgen::edit::{Change, Document, NewPart, WorldEdit};
use envgen::geometry::{Pose, Shape, wrap_angle};
use envgen::glam::DVec2;
use envgen::indoor::{Catalogue, Cell, Edit, PlanTarget, SharedRoom};
use envgen::world::{Doorway, Obstacle, ObstacleKind, Tree, Wall, WallKind};

/// A tool.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Tool {
    /// Selects and moves.
    Select,
    /// Adds rooms.
    Room,
    /// Adds and removes cells of hallways.
    Hallway,
    /// Opens and closes doorways.
    Doorway,
    /// Adds objects to rooms, or parts to worlds.
    Object,
}

impl Tool {
    /// All tools in the order of their keys, with descriptions.
    pub(crate) const ALL: [(Tool, &'static str, &'static str); 5] = [
        (Tool::Select, "Select", "Click selects, dragging moves (1)"),
        (Tool::Room, "Room", "Click puts the chosen room there, R turns it (2)"),
        (Tool::Hallway, "Hallway", "Click or drag adds cells of hallway, or removes them (3)"),
        (Tool::Doorway, "Doorway", "Click opens a wall, or closes a doorway (4)"),
        (Tool::Object, "Object", "Click puts the chosen object there, R turns it (5)"),
    ];

    /// Whether R turns what it would add.
    pub(crate) fn adds(self) -> bool {
        matches!(self, Tool::Room | Tool::Object)
    }
}

/// What the tool for objects adds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Piece {
    Obstacle(ObstacleKind),
    Wall,
    Tree,
    Doorway,
    Victim,
    Start,
    Goal,
}

impl Piece {
    const OBSTACLES: [(Piece, &'static str); 13] = [
        (Piece::Obstacle(ObstacleKind::Crate), "crate"),
        (Piece::Obstacle(ObstacleKind::Desk), "desk"),
        (Piece::Obstacle(ObstacleKind::Chair), "chair"),
        (Piece::Obstacle(ObstacleKind::Cabinet), "cabinet"),
        (Piece::Obstacle(ObstacleKind::Counter), "counter"),
        (Piece::Obstacle(ObstacleKind::Panel), "panel"),
        (Piece::Obstacle(ObstacleKind::Screen), "screen"),
        (Piece::Obstacle(ObstacleKind::Container), "container"),
        (Piece::Obstacle(ObstacleKind::Boiler), "boiler"),
        (Piece::Obstacle(ObstacleKind::Pipe), "pipe"),
        (Piece::Obstacle(ObstacleKind::Statue), "statue"),
        (Piece::Obstacle(ObstacleKind::Rubble), "rubble"),
        (Piece::Obstacle(ObstacleKind::Other), "other"),
    ];

    const OF_WORLDS: [(Piece, &'static str); 6] = [
        (Piece::Wall, "wall"),
        (Piece::Tree, "tree"),
        (Piece::Doorway, "doorway"),
        (Piece::Victim, "person to be found"),
        (Piece::Start, "start"),
        (Piece::Goal, "goal"),
    ];

    /// Returns those that can be added to a document.
    pub(crate) fn all(is_plan: bool) -> impl Iterator<Item = (Piece, &'static str)> {
        let of_worlds = Self::OF_WORLDS.into_iter().filter(move |_| !is_plan);
        Self::OBSTACLES.into_iter().chain(of_worlds)
    }

    /// Its name.
    pub(crate) fn name(self) -> &'static str {
        let found = Self::all(false).find(|(piece, _)| *piece == self);
        found.map_or("", |(_, name)| name)
    }

    /// Returns the number of its sizes: length and width, or only the width of a tree.
    pub(crate) fn sizes(self) -> usize {
        match self {
            Piece::Obstacle(_) | Piece::Wall | Piece::Doorway => 2,
            Piece::Tree => 1,
            Piece::Victim | Piece::Start | Piece::Goal => 0,
        }
    }
}

/// A drag of the tool for hallways.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Painting {
    /// Whether it adds cells or removes them.
    pub(crate) adds: bool,
    /// Where the pointer was last.
    pub(crate) at: DVec2,
    /// Whether a cell was changed. All that follow are undone with it.
    pub(crate) has_changed: bool,
}

/// The current tool, and the settings of all tools.
pub(crate) struct Tools {
    pub(crate) tool: Tool,
    is_plan: bool,
    /// The room to add, by its index in the catalogue.
    pub(crate) room: usize,
    /// Quarter turns of the room, counter-clockwise.
    quarters: u8,
    pub(crate) piece: Piece,
    /// Length and width of the object in metres.
    pub(crate) size: [f64; 2],
    /// Heading of the object in radians.
    heading: f64,
    pub(crate) paints: Option<Painting>,
}

impl Tools {
    pub(crate) fn for_document(document: &Document) -> Self {
        Tools {
            tool: Tool::Select,
            is_plan: document.plan().is_some(),
            room: 0,
            quarters: 0,
            piece: Piece::Obstacle(ObstacleKind::Crate),
            size: [0.8, 0.6],
            heading: 0.0,
            paints: None,
        }
    }

    /// Whether a tool can change the document.
    pub(crate) fn has(&self, tool: Tool) -> bool {
        self.is_plan || matches!(tool, Tool::Select | Tool::Object)
    }

    /// Turns what is to be added. Rooms turn by a quarter.
    pub(crate) fn turn(&mut self, angle: f64) {
        match self.tool {
            Tool::Room => self.quarters = (self.quarters + if angle < 0.0 { 3 } else { 1 }) % 4,
            _ => self.heading = wrap_angle(self.heading + angle),
        }
    }

    /// Returns the change that a click at a point makes, if the tool makes one, or why it makes none
    /// there.
    pub(crate) fn change_at(
        &self,
        document: &Document,
        catalogue: &Catalogue,
        p: DVec2,
    ) -> Option<Result<Change, String>> {
        match self.tool {
            Tool::Select => None,
            Tool::Room => {
                let room = catalogue.rooms().get(self.room)?;
                Some(self.add_room(document, room, p))
            }
            Tool::Hallway => self.paint(document, p, None).map(Ok),
            Tool::Doorway => {
                let gate = document.plan_editor()?.gate_at(p)?;
                let is_open = document.plan()?.outline(PlanTarget::Doorway(gate)).is_some();
                let edit = if is_open { Edit::CloseDoorway(gate) } else { Edit::OpenDoorway(gate) };
                Some(Ok(edit.into()))
            }
            Tool::Object => Some(self.add_object(document, p)),
        }
    }

    /// Returns the change that adds or removes a cell of a hallway; `None` if there is nothing to do.
    pub(crate) fn paint(
        &self,
        document: &Document,
        p: DVec2,
        adds: Option<bool>,
    ) -> Option<Change> {
        let plan = document.plan()?;
        let (x, y) = plan.cell_at(p)?;
        let is_hallway = plan.grid().get(x, y) == Some(Cell::Hallway);
        match adds.unwrap_or(!is_hallway) {
            true if !is_hallway => Some(Edit::AddHallway { x, y }.into()),
            false if is_hallway => Some(Edit::RemoveHallway { x, y }.into()),
            _ => None,
        }
    }

    /// Places a room with its middle near a point, inside of the grid.
    fn add_room(&self, document: &Document, room: &SharedRoom, p: DVec2) -> Result<Change, String> {
        let plan = document.plan().ok_or("only plans have rooms")?;
        let (room, quarters) = (room.clone(), self.quarters);
        let (width, height) = match quarters % 2 {
            0 => (room.width, room.height),
            _ => (room.height, room.width),
        };
        let grid = plan.grid();
        let cells = p / plan.spec().cell_size;
        let corner = |along: f64, size: u32, all: u32| {
            let most = f64::from(all.saturating_sub(size));
            (along - 0.5 * f64::from(size)).round().clamp(0.0, most) as u32
        };
        let x = corner(cells.x, width, grid.width());
        let y = corner(f64::from(grid.height()) - cells.y, height, grid.height());
        Ok(Edit::AddRoom { room, x, y, quarters }.into())
    }

    fn add_object(&self, document: &Document, p: DVec2) -> Result<Change, String> {
        let half_size = 0.5 * DVec2::from(self.size);
        let shape = Shape::Box { center: p, half_size, heading: self.heading };
        let pose = Pose { position: p, heading: self.heading };
        if let Some(plan) = document.plan() {
            let cell = plan.cell_at(p).and_then(|(x, y)| plan.grid().get(x, y));
            let (Some(Cell::Room(room)), Piece::Obstacle(kind)) = (cell, self.piece) else {
                return Err("objects are put into rooms".to_owned());
            };
            let (room, object) = (room as usize, Obstacle::new(kind, shape));
            return Ok(Edit::AddObject { room, object }.into());
        }
        let part = match self.piece {
            Piece::Obstacle(kind) => NewPart::Obstacle(Obstacle::new(kind, shape)),
            Piece::Wall => NewPart::Wall(Wall::new(WallKind::Wall, shape)),
            Piece::Tree => NewPart::Tree(Tree::new(p, half_size.y)),
            Piece::Doorway => NewPart::Doorway(Doorway::new(shape, true, [None, None])),
            Piece::Victim => NewPart::Victim(pose),
            Piece::Start => NewPart::Start(pose),
            Piece::Goal => NewPart::Goal(pose),
        };
        Ok(WorldEdit::Add(part).into())
    }
}
