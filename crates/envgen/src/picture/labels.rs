//! The names of rooms.

use glam::DVec2;
use svg::node::element::Group;

use super::parts::room_color;
use super::path::PathData;
use super::style::{self, Texture};
use super::symbols::{haloed, symbols};
use super::text::{Align, CAPITAL_HEIGHT, Typesetter};
use super::view::View;
use crate::geometry::Rect;
use crate::palette;
use crate::world::{Room, World};

/// The greatest number of names in a picture.
const MOST_NAMES: usize = 5000;

/// Names with more characters than this are cut.
const LONGEST_NAME: usize = 60;

/// The greatest number of obstacles that names avoid.
const MOST_OBSTACLES: usize = 500;

/// Width of the stroke of the rim around a name in px.
const HALO: f64 = 2.2;

/// The height of a line of a label, as a share of its font size.
const LINE: f64 = 1.25;

/// The greatest number of different rooms for which the legend explains numbers.
const MOST_NUMBERS: usize = 24;

/// The greatest share of a room that its name may cover if a number can replace the name.
const MOST_COVERED: f64 = 0.35;

/// Numbers of lines and font sizes of a name, the better ones first: few lines, unless they would be small. The
/// first [`READABLE`] are easy to read.
const SETTINGS: [(usize, f64); 16] = [
    (1, 12.0),
    (1, 11.0),
    (1, 10.0),
    (1, 9.0),
    (2, 10.0),
    (2, 9.0),
    (2, 8.0),
    (1, 8.0),
    (3, 8.0),
    (2, 7.0),
    (3, 7.0),
    (1, 7.0),
    (4, 7.0),
    (2, 6.0),
    (3, 6.0),
    (4, 6.0),
];
const READABLE: usize = 8;

/// The names of rooms in a picture.
#[derive(Debug, Default)]
pub(super) struct Names {
    pub(super) group: Option<Group>,
    /// The names that the numbers in small rooms represent, counted from 1.
    pub(super) numbers: Vec<String>,
}

/// Draws names in the middle of their rooms if they fit, with the difficulty below; above or below the middle if
/// this avoids another name or an obstacle, and beside start and goal. With a legend, rooms that are too small for
/// their names get numbers.
pub(super) fn draw(world: &World, view: &View, legend: bool, typesetter: &Typesetter) -> Names {
    let mut numbers: Vec<String> = Vec::new();
    let [mut dark, mut light] = [PathData::new(2), PathData::new(2)];
    let symbols = symbols(world, view);
    let mut taken = symbols.clone();
    let unnamed = taken.len();
    let mut tried = 0;
    let grounds =
        world.surfaces.iter().filter(|s| style::surface(s.kind).1.texture != Texture::Plain);
    let obstacles = world.obstacles.iter().map(|o| &o.shape).chain(grounds.map(|s| &s.shape));
    let obstacles: Vec<_> =
        obstacles.take(MOST_OBSTACLES).map(|shape| view.px_rect(shape.bounds())).collect();
    for room in &world.rooms {
        let around = view.px_rect(room.shape.bounds());
        let size = around.size();
        if size.x < 24.0 || size.y < 10.0 {
            continue;
        }
        tried += 1;
        if tried > MOST_NAMES {
            break;
        }
        let text = described(room);
        let known = numbers.iter().position(|number| *number == text);
        let number = known.unwrap_or(numbers.len());
        let number = Some(number + 1).filter(|n| legend && *n <= MOST_NUMBERS);
        let whole = Label::new(room, around, number, typesetter);
        let placed = whole.and_then(|label| {
            let at = label.place(&taken, &obstacles)?;
            Some((label, at))
        });
        // Beside a symbol, in the part where the label becomes largest.
        let aside = || {
            let parts = symbols.iter().flat_map(|symbol| around_symbol(around, *symbol));
            let labels = parts.filter_map(|part| Label::new(room, part, number, typesetter));
            let placed = labels.filter_map(|label| {
                let at = label.place(&taken, &[])?;
                Some((label, at))
            });
            placed.max_by_key(|(label, _)| label.rank)
        };
        let Some((label, at)) = placed.or_else(aside) else { continue };
        taken.push(at);
        if label.is_number && known.is_none() {
            numbers.push(text);
        }
        let ink = if room_color(room).lightness() > 0.52 { &mut dark } else { &mut light };
        let mut top = at.min.y;
        for (line, font) in label.lines {
            let baseline = top + (LINE + CAPITAL_HEIGHT) * 0.5 * font;
            let at = DVec2::new(at.center().x, baseline);
            typesetter.write(ink, &line, at, font, Align::Middle);
            top += LINE * font;
        }
    }
    if taken.len() == unnamed {
        return Names::default();
    }
    let mut group = Group::new().set("id", "names");
    if !dark.is_empty() {
        group = group.add(haloed(dark, palette::INK, palette::PAGE, HALO));
    }
    if !light.is_empty() {
        group = group.add(haloed(light, palette::PAGE, palette::INK, HALO));
    }
    Names { group: Some(group), numbers }
}

/// Returns all text of a room's label, in one line.
fn described(room: &Room) -> String {
    std::iter::once(shown_name(room)).chain(notes(room)).collect::<Vec<_>>().join(" ")
}

/// Returns the name of a room, cut with an ellipsis if it is too long.
fn shown_name(room: &Room) -> String {
    let name = room.name.trim();
    match name.char_indices().nth(LONGEST_NAME) {
        Some(_) => {
            let kept: String = name.chars().take(LONGEST_NAME - 1).collect();
            format!("{}…", kept.trim_end())
        }
        None => name.to_owned(),
    }
}

/// Returns the difficulty of a room, and which contents were removed.
fn notes(room: &Room) -> impl Iterator<Item = String> {
    let contents = Some(room.contents).filter(|contents| !contents.is_as_designed());
    let contents = contents.map(|contents| contents.name().to_owned());
    room.difficulty.map(difficulty).into_iter().chain(contents)
}

/// Returns the parts of a room beside a symbol that lies in it: below, above, left and right.
fn around_symbol(room: Rect, symbol: Rect) -> Vec<Rect> {
    if !room.overlaps(symbol) {
        return Vec::new();
    }
    let mut parts = vec![
        Rect::new(DVec2::new(room.min.x, symbol.max.y), room.max),
        Rect::new(room.min, DVec2::new(room.max.x, symbol.min.y)),
        Rect::new(room.min, DVec2::new(symbol.min.x, room.max.y)),
        Rect::new(DVec2::new(symbol.max.x, room.min.y), room.max),
    ];
    parts.retain(|part| part.size().cmpgt(DVec2::ZERO).all());
    parts
}

/// A room's label, and the space for it.
struct Label {
    space: Rect,
    /// The lines of the label, with their font sizes.
    lines: Vec<(String, f64)>,
    size: DVec2,
    /// The rank of the label; greater is better.
    rank: usize,
    is_number: bool,
}

impl Label {
    /// Creates a label with the room's name in as few lines and as large as fits, its difficulty, and which
    /// contents were removed. If this would be small or cover too much of the room, the label is the room's number;
    /// without a number, the name is made smaller and then cut. `None` if nothing fits.
    fn new(
        room: &Room,
        space: Rect,
        number: Option<usize>,
        typesetter: &Typesetter,
    ) -> Option<Label> {
        let most = space.size() - DVec2::new(6.0, 4.0);
        let measure = |lines: &[(String, f64)]| {
            let widths = lines.iter().map(|line| typesetter.width(&line.0, line.1));
            let height: f64 = lines.iter().map(|line| LINE * line.1).sum();
            DVec2::new(widths.fold(0.0, f64::max), height)
        };
        let of = |lines: Vec<(String, f64)>, rank| {
            let size = measure(&lines);
            let fits = !lines.is_empty() && size.cmple(most).all();
            fits.then_some(Label { space, lines, size, rank, is_number: false })
        };
        let with_notes = |mut lines: Vec<(String, f64)>, font: f64| {
            lines.extend(notes(room).map(|note| (note, 0.85 * font)));
            lines
        };
        let name = shown_name(room);
        let allowed = if number.is_some() { READABLE } else { SETTINGS.len() };
        let full = SETTINGS[..allowed].iter().enumerate().find_map(|(i, &(lines, font))| {
            let wrapped = typesetter.wrapped(&name, font, most.x, lines)?;
            let wrapped = wrapped.into_iter().map(|line| (line, font)).collect();
            of(with_notes(wrapped, font), SETTINGS.len() - i)
        });
        if let Some(number) = number {
            let area = |size: DVec2| size.x * size.y;
            let covers = |label: &Label| area(label.size) > MOST_COVERED * area(space.size());
            return full.filter(|label| !covers(label)).or_else(|| {
                let label = of(vec![(number.to_string(), 10.0)], 0)?;
                Some(Label { is_number: true, ..label })
            });
        }
        full.or_else(|| {
            let cut = typesetter.fitted(&name, 8.0, most.x).filter(|cut| !cut.is_empty());
            let mut lines = cut.into_iter().map(|cut| (cut, 8.0)).collect();
            lines = with_notes(lines, 9.0);
            while !lines.is_empty() && !measure(&lines).cmple(most).all() {
                lines.pop();
            }
            of(lines, 0)
        })
    }

    /// Returns a position that does not overlap what is taken and, if possible, no obstacles.
    fn place(&self, taken: &[Rect], obstacles: &[Rect]) -> Option<Rect> {
        let aside = (0.5 * (self.space.size().y - self.size.y) - 7.0).max(0.0);
        let places = [0.0, 0.5, -0.5, 1.0, -1.0].map(|share| {
            let center = self.space.center() + DVec2::new(0.0, share * aside);
            Rect::new(center - 0.5 * self.size, center + 0.5 * self.size)
        });
        let apart = |at: &Rect, from: &[Rect]| from.iter().all(|other| !other.overlaps(*at));
        let free = || places.into_iter().filter(|at| apart(at, taken));
        free().find(|at| apart(at, obstacles)).or_else(|| free().next())
    }
}

/// Formats a difficulty with one decimal, or with two if it has two.
fn difficulty(difficulty: f64) -> String {
    let text = format!("{difficulty:.2}");
    text.strip_suffix('0').map_or(text.clone(), str::to_owned)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Shape;
    use crate::provenance::Provenance;
    use crate::world::Contents;

    fn label(name: &str, space: Rect) -> Label {
        let shape = Shape::from_rect(Rect::new(DVec2::ZERO, DVec2::ONE));
        let (name, difficulty, contents) = (name.to_owned(), Some(7.25), Contents::Cleared);
        let room = Room { name, shape, difficulty, lit: true, contents, height: None };
        Label::new(&room, space, None, &Typesetter::new()).unwrap()
    }

    #[test]
    fn difficulties_are_not_rounded_to_a_tenth() {
        let shown = [0.0, 0.5, 5.25, 6.8, 10.0, 1.0 / 3.0].map(difficulty);
        assert_eq!(shown, ["0.0", "0.5", "5.25", "6.8", "10.0", "0.33"]);
    }

    #[test]
    fn long_names_break_before_they_are_cut() {
        let cell = Rect::new(DVec2::ZERO, DVec2::splat(48.0));
        let text = |label: &Label| -> Vec<String> {
            label.lines.iter().map(|line| line.0.clone()).collect()
        };
        let small = label("single office north destroyed", cell);
        assert_eq!(text(&small)[..2].join(" ") + " " + &text(&small)[2..].join(" "), {
            "single office north destroyed 7.25 cleared"
        });
        let wide = Rect::new(DVec2::ZERO, DVec2::new(400.0, 60.0));
        assert_eq!(text(&label("dragon room", wide)), ["dragon room", "7.25", "cleared"]);
        let cut = label("Donaudampfschifffahrtsgesellschaft", cell);
        assert!(text(&cut)[0].ends_with('…') && cut.rank == 0);
    }

    #[test]
    fn cut_names_end_with_an_ellipsis() {
        let shown = |name: &str| {
            let room = Room {
                name: name.to_owned(),
                shape: Shape::from_rect(Rect::new(DVec2::ZERO, DVec2::ONE)),
                difficulty: Some(7.25),
                lit: true,
                contents: Contents::default(),
                height: None,
            };
            described(&room)
        };
        let long = "ä".repeat(60);
        assert_eq!(shown(&format!(" {long} ")), format!("{long} 7.25"));
        assert_eq!(shown(&format!("{long}ä")), format!("{}… 7.25", "ä".repeat(59)));
        let spaced = format!("{} {}", "a".repeat(58), "b".repeat(20));
        assert_eq!(shown(&spaced), format!("{}… 7.25", "a".repeat(58)));

        let wide = Rect::new(DVec2::ZERO, DVec2::new(900.0, 60.0));
        let label = label(&format!("{long}ä"), wide);
        assert_eq!(label.lines[0].0, format!("{}…", "ä".repeat(59)));
    }

    #[test]
    fn small_rooms_bear_numbers_that_the_legend_explains() {
        let room = |name: &str, corner: DVec2, side: f64| Room {
            name: name.to_owned(),
            shape: Shape::from_rect(Rect::new(corner, corner + side)),
            difficulty: Some(7.25),
            lit: true,
            contents: Contents::default(),
            height: None,
        };
        let long = "single office north destroyed";
        let bounds = Rect::new(DVec2::ZERO, DVec2::new(40.0, 20.0));
        let mut world = World::new(Provenance::other("manual", serde_json::Value::Null), bounds);
        world.rooms = vec![
            room(long, DVec2::ZERO, 3.0),
            room("hall", DVec2::new(10.0, 0.0), 20.0),
            room(long, DVec2::new(4.0, 0.0), 3.0),
            room("single office south", DVec2::new(4.0, 4.0), 3.0),
        ];
        let least = DVec2::splat(100.0);
        let view = View::new(world.bounds, DVec2::ZERO, least, DVec2::new(640.0, 400.0), 10.0);
        let view = view.unwrap();
        let names = draw(&world, &view, true, &Typesetter::new());
        assert_eq!(names.numbers, [format!("{long} 7.25"), "single office south 7.25".to_owned()]);
        assert!(names.group.is_some());
        assert!(draw(&world, &view, false, &Typesetter::new()).numbers.is_empty());
    }

    #[test]
    fn names_go_beside_symbols() {
        let room = Rect::new(DVec2::ZERO, DVec2::splat(48.0));
        let symbol = Rect::new(DVec2::new(20.0, 0.0), DVec2::new(42.0, 26.0));
        let name = label("office", room);
        assert_eq!(name.place(&[symbol], &[]), None);
        let parts = around_symbol(room, symbol);
        assert_eq!(parts.len(), 3);
        let apart = |part: &Rect| !part.grown(-0.1).overlaps(symbol);
        assert!(parts.iter().all(|part| apart(part) && room.contains_rect(*part)));
        let below = label("office", parts[0]);
        assert!(below.place(&[symbol], &[]).is_some());
        assert!(around_symbol(room, Rect::new(DVec2::splat(50.0), DVec2::splat(60.0))).is_empty());
    }
}
