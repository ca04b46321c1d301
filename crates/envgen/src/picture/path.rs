//! Path data of SVG: short, quantised, and the same text on every machine.

use std::fmt::Write;

use glam::DVec2;

/// The distance of the control points of a quarter circle of radius 1 from its ends.
const QUARTER: f64 = 0.552_284_749_830_793_4;

/// The greatest pixel coordinate, to which coordinates are clamped: far outside any picture, and well within `f32`.
const FARTHEST: f64 = 1e6;

/// The `d` attribute of an SVG path. Coordinates are rounded to a fraction of a pixel and written relative to the
/// previous one, as differences of rounded numbers, so that errors do not add up.
#[derive(Clone, Debug)]
pub(super) struct PathData {
    text: String,
    steps_per_px: f64,
    decimals: u32,
    at: [i64; 2],
    start: [i64; 2],
    command: char,
    number_has_point: bool,
}

impl PathData {
    /// Creates an empty path whose coordinates have this many decimals.
    pub(super) fn new(decimals: u32) -> Self {
        PathData {
            text: String::new(),
            steps_per_px: 10_u32.pow(decimals).into(),
            decimals,
            at: [0; 2],
            start: [0; 2],
            command: ' ',
            number_has_point: false,
        }
    }

    pub(super) fn is_empty(&self) -> bool {
        self.text.is_empty()
    }

    pub(super) fn into_text(self) -> String {
        self.text
    }

    pub(super) fn move_to(&mut self, p: DVec2) {
        let to = self.quantised(p);
        let [dx, dy] = self.offset(to);
        if self.text.is_empty() {
            self.numbers('M', &[dx, dy]);
        } else {
            self.numbers('m', &[dx, dy]);
        }
        (self.at, self.start) = (to, to);
    }

    /// Adds a line, unless it is shorter than the resolution of the coordinates.
    pub(super) fn line_to(&mut self, p: DVec2) {
        let to = self.quantised(p);
        match self.offset(to) {
            [0, 0] => return,
            [dx, 0] => self.numbers('h', &[dx]),
            [0, dy] => self.numbers('v', &[dy]),
            [dx, dy] => self.numbers('l', &[dx, dy]),
        }
        self.at = to;
    }

    pub(super) fn quadratic_to(&mut self, control: DVec2, p: DVec2) {
        let (control, to) = (self.quantised(control), self.quantised(p));
        let ([cx, cy], [dx, dy]) = (self.offset(control), self.offset(to));
        self.numbers('q', &[cx, cy, dx, dy]);
        self.at = to;
    }

    pub(super) fn cubic_to(&mut self, c1: DVec2, c2: DVec2, p: DVec2) {
        let (c1, c2, to) = (self.quantised(c1), self.quantised(c2), self.quantised(p));
        let ([ax, ay], [bx, by], [dx, dy]) = (self.offset(c1), self.offset(c2), self.offset(to));
        self.numbers('c', &[ax, ay, bx, by, dx, dy]);
        self.at = to;
    }

    pub(super) fn close(&mut self) {
        self.text.push('z');
        self.command = 'z';
        self.at = self.start;
    }

    /// Adds a point, which is visible as a round line cap if the path is stroked with one.
    pub(super) fn dot(&mut self, p: DVec2) {
        self.move_to(p);
        self.numbers('h', &[0]);
    }

    pub(super) fn line(&mut self, a: DVec2, b: DVec2) {
        self.move_to(a);
        self.line_to(b);
    }

    pub(super) fn polyline(&mut self, points: impl IntoIterator<Item = DVec2>) {
        for (i, p) in points.into_iter().enumerate() {
            if i == 0 {
                self.move_to(p);
            } else {
                self.line_to(p);
            }
        }
    }

    pub(super) fn polygon(&mut self, points: impl IntoIterator<Item = DVec2>) {
        self.polyline(points);
        self.close();
    }

    pub(super) fn rect(&mut self, min: DVec2, max: DVec2) {
        self.polygon([min, DVec2::new(max.x, min.y), max, DVec2::new(min.x, max.y)]);
    }

    pub(super) fn circle(&mut self, center: DVec2, radius: f64) {
        let (r, k) = (radius, radius * QUARTER);
        let at = |x, y| center + DVec2::new(x, y);
        self.move_to(at(r, 0.0));
        self.cubic_to(at(r, k), at(k, r), at(0.0, r));
        self.cubic_to(at(-k, r), at(-r, k), at(-r, 0.0));
        self.cubic_to(at(-r, -k), at(-k, -r), at(0.0, -r));
        self.cubic_to(at(k, -r), at(r, -k), at(r, 0.0));
        self.close();
    }

    fn quantised(&self, p: DVec2) -> [i64; 2] {
        let step = |v: f64| (v.clamp(-FARTHEST, FARTHEST) * self.steps_per_px).round() as i64;
        [step(p.x), step(p.y)]
    }

    fn offset(&self, to: [i64; 2]) -> [i64; 2] {
        [to[0] - self.at[0], to[1] - self.at[1]]
    }

    fn numbers(&mut self, command: char, numbers: &[i64]) {
        // A repeated command is written without its letter; after a move the omitted letter is l.
        let repeated = command == self.command && command != 'm';
        if !repeated {
            self.text.push(command);
        }
        self.command = command;
        for (i, &number) in numbers.iter().enumerate() {
            self.number(number, i > 0 || repeated);
        }
    }

    fn number(&mut self, number: i64, follows: bool) {
        let one = 10_u64.pow(self.decimals);
        let (whole, mut part) = (number.unsigned_abs() / one, number.unsigned_abs() % one);
        let starts_with_point = whole == 0 && part > 0;
        if number < 0 {
            self.text.push('-');
        } else if follows && !(starts_with_point && self.number_has_point) {
            self.text.push(' ');
        }
        let mut digits = self.decimals as usize;
        while part > 0 && part % 10 == 0 {
            part /= 10;
            digits -= 1;
        }
        let written = match (whole, part) {
            (_, 0) => write!(self.text, "{whole}"),
            (0, _) => write!(self.text, ".{part:0digits$}"),
            _ => write!(self.text, "{whole}.{part:0digits$}"),
        };
        debug_assert!(written.is_ok(), "writing to a string does not fail");
        self.number_has_point = part > 0;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use resvg::usvg;

    fn v(x: f64, y: f64) -> DVec2 {
        DVec2::new(x, y)
    }

    #[test]
    fn paths_are_short() {
        let mut path = PathData::new(2);
        path.rect(v(1.0, 2.0), v(3.5, 2.25));
        path.line(v(0.0, 0.0), v(0.5, 0.5));
        path.line_to(v(1.0, 0.25));
        path.line_to(v(1.0, 0.251));
        path.dot(v(-1.0, 0.0));
        assert_eq!(path.into_text(), "M1 2h2.5v.25h-2.5zm-1-2l.5.5.5-.25m-2-.25h0");
    }

    #[test]
    fn what_is_no_number_stays_in_the_picture() {
        let mut path = PathData::new(1);
        path.line(v(f64::NAN, f64::INFINITY), v(f64::NEG_INFINITY, 0.0));
        assert_eq!(path.into_text(), "M0 1000000l-1000000-1000000");
    }

    proptest! {
        #[test]
        fn a_reader_finds_the_same_points(
            points in prop::collection::vec((-2e3..2e3_f64, -2e3..2e3_f64), 2..40),
        ) {
            let mut path = PathData::new(2);
            path.polyline(points.iter().map(|&(x, y)| v(x, y)));
            let text = format!(
                "<svg xmlns='http://www.w3.org/2000/svg'><path stroke='red' d='{}'/></svg>",
                path.into_text()
            );
            let tree = usvg::Tree::from_str(&text, &usvg::Options::default()).unwrap();
            let usvg::Node::Path(read) = &tree.root().children()[0] else { panic!("{text}") };
            let mut wanted: Vec<_> = points.iter().map(|&(x, y)| v(x, y)).collect();
            wanted.dedup_by(|a, b| (*a * 100.0).round() == (*b * 100.0).round());
            prop_assert_eq!(read.data().points().len(), wanted.len());
            for (p, w) in read.data().points().iter().zip(wanted) {
                prop_assert!(v(p.x.into(), p.y.into()).distance(w) < 0.0076, "{:?} {}", p, w);
            }
        }
    }
}
