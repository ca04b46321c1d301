//! Figures: maps of coloured cells with a title, a legend and notes.

use std::io::Write;

use glam::DVec2;
use svg::node::element::Group;

use super::ink::Indexed;
use super::legend::{self, Entry};
use super::page::{TITLE_HEIGHT, page};
use super::path::PathData;
use super::shapes::{filled, rectangle};
use super::style::Style;
use super::text::{Align, Typesetter};
use super::title::Heading;
use super::view::View;
use super::{MAX_PIXELS, PictureError, pixels};
use crate::geometry::Rect;
use crate::palette::{self, PartColor, Srgb};

const MARGIN: f64 = 16.0;
const NOTE_SIZE: f64 = 12.0;
const NOTE_ROW: f64 = 17.0;

/// The least and the greatest length of the map's longer side in px. A PNG has at least one pixel per cell in any case.
const SIDES: [f64; 2] = [480.0, 1000.0];

/// A map of coloured cells, such as a robot's map, with a scale bar, a legend and notes.
///
/// ```
/// use envgen::palette::map;
/// use envgen::picture::Figure;
///
/// let figure = Figure {
///     title: "a wall".to_owned(),
///     cell: 0.05,
///     width: 2,
///     cells: vec![0, 1, 0, 1],
///     colors: vec![(map::FREE, "free".to_owned()), (map::OCCUPIED, "wall".to_owned())],
///     notes: vec!["coverage 100 %".to_owned()],
/// };
/// let mut file = Vec::new();
/// figure.write_png(&mut file)?;
/// assert!(file.starts_with(b"\x89PNG"));
/// # Ok::<(), envgen::picture::PictureError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Figure {
    /// The title above the map; empty for no title.
    pub title: String,
    /// Side of a cell in metres.
    pub cell: f64,
    /// Number of cells in a row.
    pub width: u32,
    /// The index of each cell's colour, row by row from the top.
    pub cells: Vec<u8>,
    /// The colours and their meanings. The legend shows those that occur and have a name.
    pub colors: Vec<(Srgb, String)>,
    /// Lines below the legend.
    pub notes: Vec<String>,
}

impl Figure {
    /// Returns the figure as SVG.
    ///
    /// # Errors
    /// When there are no cells, when they do not fill whole rows, when their side is not a positive number, when a
    /// colour is missing, or when the map has more than [`MAX_PIXELS`] cells.
    pub fn svg(&self) -> Result<String, PictureError> {
        let (width, height) = (u64::from(self.width), self.height()?);
        if width * height > MAX_PIXELS {
            return Err(PictureError::TooLarge { width, height });
        }
        let mut present = vec![false; self.colors.len()];
        for &cell in &self.cells {
            *present
                .get_mut(usize::from(cell))
                .ok_or(PictureError::Cells("have a colour each"))? = true;
        }
        let cells = DVec2::new(width as f64, height as f64);
        let area = Rect::new(DVec2::ZERO, cells * self.cell);
        let heading = Heading::plain(self.title.clone());
        let top = if heading.name.is_empty() { MARGIN } else { MARGIN + TITLE_HEIGHT };
        let side = cells.max_element().clamp(SIDES[0], SIDES[1]);
        let most = cells * (side / cells.max_element());
        let view = View::new(area, DVec2::new(MARGIN, top), DVec2::ONE, most.ceil(), 0.0)
            .ok_or(PictureError::Scale(area))?;

        let typesetter = Typesetter::new();
        let plan = view.plan;
        let entries =
            self.colors.iter().zip(present).filter(|((_, name), here)| *here && !name.is_empty());
        let entries = entries.map(|((color, name), _)| {
            let edge = color.mix(palette::INK, 0.35);
            Entry::Named(Style::new("", PartColor { fill: *color, edge }), name.clone())
        });
        let corner = DVec2::new(plan.min.x, plan.max.y + 8.0);
        // Narrow maps may still have wide legends.
        let room = plan.size().x.max(SIDES[0]);
        let (legend, size) = legend::draw(entries.collect(), &view, corner, room, &typesetter);
        let right = plan.max.x.max(corner.x + size.x);
        let mut notes = PathData::new(2);
        let mut bottom = corner.y + size.y;
        for note in &self.notes {
            let text = typesetter.fitted(note, NOTE_SIZE, room).unwrap_or_default();
            let at = DVec2::new(plan.min.x, bottom + 0.8 * NOTE_ROW);
            typesetter.write(&mut notes, &text, at, NOTE_SIZE, Align::Left);
            bottom += NOTE_ROW;
        }
        let indexed = Indexed {
            width: self.width,
            height: height as u32,
            colors: self.colors.iter().map(|(color, _)| *color).collect(),
            alphas: Vec::new(),
            pixels: self.cells.clone(),
        };
        let right = right.max(plan.min.x + room.min(self.notes_width(&typesetter)));
        let mut document = page(DVec2::new(right + MARGIN, bottom + MARGIN).ceil(), &heading);
        if !heading.name.is_empty() {
            document = document.add(heading.row(&view, right, &typesetter));
        }
        document = document.add(indexed.to_element(plan.min, plan.size())?);
        let frame = rectangle(Rect::new(plan.min + 0.5, plan.max - 0.5))
            .set("fill", "none")
            .set("stroke", palette::FRAME.to_string());
        document = document.add(frame).add(legend);
        if !notes.is_empty() {
            document =
                document.add(Group::new().set("id", "notes").add(filled(notes, palette::INK)));
        }
        Ok(document.to_string() + "\n")
    }

    /// Writes the figure as a PNG file, with at least one pixel per cell.
    ///
    /// # Errors
    /// The errors of [`Figure::svg`], and when writing fails.
    pub fn write_png(&self, out: &mut dyn Write) -> Result<(), PictureError> {
        let longest = u64::from(self.width).max(self.height()?) as f64;
        pixels::render(&self.svg()?, (longest / SIDES[1]).max(1.0))?.write(out)
    }

    fn notes_width(&self, typesetter: &Typesetter) -> f64 {
        let widths = self.notes.iter().map(|note| typesetter.width(note, NOTE_SIZE));
        widths.fold(0.0, f64::max)
    }

    fn height(&self) -> Result<u64, PictureError> {
        let (cells, width) = (self.cells.len() as u64, u64::from(self.width));
        if width == 0 || cells == 0 || !cells.is_multiple_of(width) {
            return Err(PictureError::Cells("come in whole rows"));
        }
        if !(self.cell.is_finite() && self.cell > 0.0) {
            return Err(PictureError::Cells("have a positive side"));
        }
        Ok(cells / width)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::palette::map;

    fn figure() -> Figure {
        Figure {
            title: "map".to_owned(),
            cell: 0.05,
            width: 3,
            cells: vec![0, 1, 0, 1, 1, 1],
            colors: vec![(map::FREE, "free".to_owned()), (map::OCCUPIED, "wall".to_owned())],
            notes: vec!["a note".to_owned()],
        }
    }

    #[test]
    fn figures_show_what_occurs() {
        let rectangles = |figure: &Figure| {
            let svg = figure.svg().unwrap();
            let legend = svg.split("id=\"legend\"").nth(1).unwrap();
            legend.matches("stroke-width=\"0.8\"").count()
        };
        let both = figure();
        assert_eq!(rectangles(&both), 2);
        let one = Figure { cells: vec![1; 6], ..figure() };
        assert_eq!(rectangles(&one), 1);
        let nameless = Figure {
            colors: vec![(map::FREE, String::new()), (map::OCCUPIED, "w".into())],
            ..both
        };
        assert_eq!(rectangles(&nameless), 1);
    }

    #[test]
    fn pngs_hold_every_cell() {
        let size = |figure: &Figure| {
            let mut file = Vec::new();
            figure.write_png(&mut file).unwrap();
            let info = png::Decoder::new(std::io::Cursor::new(file)).read_info().unwrap();
            (info.info().width, info.info().height)
        };
        let (width, height) = size(&figure());
        assert!(width >= 480 && height > 320, "{width} x {height}");
        let wide = Figure { width: 2500, cells: vec![0; 2500 * 100], ..figure() };
        assert!(size(&wide).0 >= 2500);
    }

    #[test]
    fn broken_figures_are_refused() {
        let refused = |figure: Figure| figure.svg().unwrap_err().to_string();
        assert!(refused(Figure { width: 0, ..figure() }).contains("whole rows"));
        assert!(refused(Figure { width: 4, ..figure() }).contains("whole rows"));
        assert!(refused(Figure { cells: Vec::new(), ..figure() }).contains("whole rows"));
        assert!(refused(Figure { cells: vec![2; 3], ..figure() }).contains("colour"));
        for cell in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            assert!(refused(Figure { cell, ..figure() }).contains("positive"));
        }
    }
}
