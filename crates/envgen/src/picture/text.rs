//! Labels, drawn as outlines of an embedded font (Noto Sans, SIL Open Font License 1.1), so that they are the same
//! in every program and on every machine.

use glam::DVec2;
use ttf_parser::{Face, GlyphId, OutlineBuilder};

use super::path::PathData;

/// The point of a label that is placed at the given position.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Align {
    Left,
    Middle,
    Right,
}

/// The height of capital letters, as a share of the font size.
pub(super) const CAPITAL_HEIGHT: f64 = 0.714;

/// Writes labels into paths.
#[derive(Debug)]
pub(super) struct Typesetter {
    /// The font; `None` if it cannot be read, which a test excludes.
    face: Option<Face<'static>>,
}

impl Typesetter {
    pub(super) fn new() -> Self {
        Typesetter { face: Face::parse(notosans::REGULAR_TTF, 0).ok() }
    }

    fn scale(face: &Face<'_>, size: f64) -> f64 {
        size / f64::from(face.units_per_em().max(1))
    }

    /// Returns the width of a label in px.
    pub(super) fn width(&self, label: &str, size: f64) -> f64 {
        let Some(face) = &self.face else { return 0.0 };
        let units: f64 = label.chars().map(|c| advance(face, glyph(face, c))).sum();
        units * Self::scale(face, size)
    }

    /// Writes a label with its baseline at `at`.
    pub(super) fn write(
        &self,
        path: &mut PathData,
        label: &str,
        at: DVec2,
        size: f64,
        align: Align,
    ) {
        let Some(face) = &self.face else { return };
        let scale = Self::scale(face, size);
        let shift = match align {
            Align::Left => 0.0,
            Align::Middle => 0.5,
            Align::Right => 1.0,
        };
        let mut origin = at - DVec2::new(shift * self.width(label, size), 0.0);
        for c in label.chars() {
            let glyph = glyph(face, c);
            face.outline_glyph(glyph, &mut Outline { path, origin, scale });
            origin.x += advance(face, glyph) * scale;
        }
    }

    /// Breaks the label between words into at most the given number of lines, none of them wider than `width` px;
    /// `None` if this is impossible, or if the label is empty.
    pub(super) fn wrapped(
        &self,
        label: &str,
        size: f64,
        width: f64,
        most: usize,
    ) -> Option<Vec<String>> {
        let mut lines: Vec<String> = Vec::new();
        for word in label.split_whitespace() {
            let longer = lines.last().map(|line| format!("{line} {word}"));
            match longer.filter(|line| self.width(line, size) <= width) {
                Some(longer) => *lines.last_mut()? = longer,
                None if lines.len() < most && self.width(word, size) <= width => {
                    lines.push(word.to_owned());
                }
                None => return None,
            }
        }
        (!lines.is_empty()).then_some(lines)
    }

    /// Returns the label, cut with an ellipsis if it is wider than `width` px; `None` if not even a few letters
    /// fit.
    pub(super) fn fitted(&self, label: &str, size: f64, width: f64) -> Option<String> {
        if self.width(label, size) <= width {
            return Some(label.to_owned());
        }
        let mut cut = String::new();
        let mut used = self.width("…", size);
        let mut letter = [0; 4];
        for c in label.chars() {
            used += self.width(c.encode_utf8(&mut letter), size);
            if used > width {
                break;
            }
            cut.push(c);
        }
        let cut = cut.trim_end();
        (cut.chars().count() >= 3).then(|| format!("{cut}…"))
    }
}

fn glyph(face: &Face<'_>, c: char) -> GlyphId {
    // Glyph 0 is the box for characters that the font does not have.
    face.glyph_index(c).unwrap_or(GlyphId(0))
}

fn advance(face: &Face<'_>, glyph: GlyphId) -> f64 {
    f64::from(face.glyph_hor_advance(glyph).unwrap_or(0))
}

struct Outline<'a> {
    path: &'a mut PathData,
    origin: DVec2,
    scale: f64,
}

impl Outline<'_> {
    fn at(&self, x: f32, y: f32) -> DVec2 {
        self.origin + DVec2::new(f64::from(x), -f64::from(y)) * self.scale
    }
}

impl OutlineBuilder for Outline<'_> {
    fn move_to(&mut self, x: f32, y: f32) {
        self.path.move_to(self.at(x, y));
    }

    fn line_to(&mut self, x: f32, y: f32) {
        self.path.line_to(self.at(x, y));
    }

    fn quad_to(&mut self, x1: f32, y1: f32, x: f32, y: f32) {
        self.path.quadratic_to(self.at(x1, y1), self.at(x, y));
    }

    fn curve_to(&mut self, x1: f32, y1: f32, x2: f32, y2: f32, x: f32, y: f32) {
        self.path.cubic_to(self.at(x1, y1), self.at(x2, y2), self.at(x, y));
    }

    fn close(&mut self) {
        self.path.close();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_font_has_what_labels_need() {
        let typesetter = Typesetter::new();
        let face = typesetter.face.as_ref().unwrap();
        for c in ('!'..='~').chain("…×·°äöüßéèñ−²µ".chars()) {
            assert!(face.glyph_index(c).is_some(), "{c}");
        }
        assert!((9.0..11.0).contains(&typesetter.width("00", 8.8)));
    }

    #[test]
    fn labels_break_between_words() {
        let typesetter = Typesetter::new();
        let wrapped =
            |width, most| typesetter.wrapped("a room with  a longname", 10.0, width, most);
        assert_eq!(wrapped(500.0, 1).unwrap(), ["a room with a longname"]);
        let lines = wrapped(60.0, 3).unwrap();
        assert_eq!(lines.join(" "), "a room with a longname");
        assert!(lines.len() > 1 && lines.iter().all(|l| typesetter.width(l, 10.0) <= 60.0));
        assert_eq!((wrapped(60.0, 1), wrapped(20.0, 9)), (None, None));
        assert_eq!(typesetter.wrapped(" ", 10.0, 60.0, 3), None);
    }

    #[test]
    fn labels_are_cut_to_fit() {
        let typesetter = Typesetter::new();
        let label = "a room with a long name";
        let cut = typesetter.fitted(label, 10.0, 60.0).unwrap();
        assert!(cut.ends_with('…') && typesetter.width(&cut, 10.0) <= 60.0, "{cut}");
        assert_eq!(typesetter.fitted(label, 10.0, 500.0).unwrap(), label);
        assert_eq!(typesetter.fitted(label, 10.0, 12.0), None);
    }
}
