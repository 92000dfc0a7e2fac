//! The corpora: cubic curves, every one at the scale where the size of what it belongs to is 1.
use super::Cubic;
use crate::families::{regular, shape};
use crate::out;
use kurbo::{BezPath, PathSeg};
use std::path::{Path, PathBuf};

/// A corpus by its name.
pub fn cubics(name: &str) -> Vec<Cubic> {
    match name {
        "random" => random(5_000),
        "regular" => (0..2_000).map(regular).map(|cubic| to_size_1(&cubic)).collect(),
        "hard" => (0..4_500)
            .map(|seed| shape::<2>(seed).control)
            .filter(|c| size(c) > 0.0)
            .map(|c| to_size_1(&c))
            .collect(),
        "icons" => icons(),
        "letters" => letters(),
        other => panic!("no corpus is called {other}"),
    }
}

/// The diagonal of the box of the control points.
fn size(cubic: &Cubic) -> f64 {
    let extent = |k: usize| {
        let of = |pick: fn(f64, f64) -> f64| cubic.iter().map(|p| p[k]).reduce(pick).unwrap_or(0.0);
        of(f64::max) - of(f64::min)
    };
    extent(0).hypot(extent(1))
}

fn to_size_1(cubic: &Cubic) -> Cubic {
    let size = size(cubic);
    cubic.map(|p| p.map(|x| x / size))
}

/// Control points evenly from the unit square.
fn random(n: usize) -> Vec<Cubic> {
    let mut state = 12_345_u64;
    let mut next = || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 / (1_u64 << 53) as f64
    };
    (0..n).map(|_| to_size_1(&std::array::from_fn(|_| [next(), next()]))).collect()
}

fn package(name: &str) -> PathBuf {
    let path = out().join("../curves/node_modules").join(name);
    assert!(path.is_dir(), "{} is missing; run `make -C bench curves`", path.display());
    path
}

/// The curves of a path; quadratic ones raised, lines left out.
fn curves_of(path: &BezPath, scale: f64) -> impl Iterator<Item = Cubic> + '_ {
    let curved = path.segments().filter(|segment| !matches!(segment, PathSeg::Line(_)));
    curved.map(move |segment| {
        let c = segment.to_cubic();
        [c.p0, c.p1, c.p2, c.p3].map(|p| [p.x / scale, p.y / scale])
    })
}

/// Every fifteenth icon of Material Design Icons, 24 units wide and high.
fn icons() -> Vec<Cubic> {
    let folder = package("@mdi/svg").join("svg");
    let entries = std::fs::read_dir(&folder).expect("a folder of icons");
    let mut files: Vec<PathBuf> = entries.map(|entry| entry.expect("an icon").path()).collect();
    files.sort();
    let paths = files.iter().step_by(15).map(|file| BezPath::from_svg(&path_data(file)).expect("path data"));
    paths.flat_map(|path| curves_of(&path, 24.0).collect::<Vec<_>>()).collect()
}

/// The path data of an icon, of which these have one.
fn path_data(file: &Path) -> String {
    let text = std::fs::read_to_string(file).expect("an icon");
    let (_, from) = text.split_once(" d=\"").expect("a path");
    from.split('"').next().unwrap_or("").to_owned()
}

struct Outline(BezPath);

impl ttf_parser::OutlineBuilder for Outline {
    fn move_to(&mut self, x: f32, y: f32) {
        self.0.move_to((x, y));
    }
    fn line_to(&mut self, x: f32, y: f32) {
        self.0.line_to((x, y));
    }
    fn quad_to(&mut self, x1: f32, y1: f32, x: f32, y: f32) {
        self.0.quad_to((x1, y1), (x, y));
    }
    fn curve_to(&mut self, x1: f32, y1: f32, x2: f32, y2: f32, x: f32, y: f32) {
        self.0.curve_to((x1, y1), (x2, y2), (x, y));
    }
    fn close(&mut self) {
        self.0.close_path();
    }
}

/// Every third glyph of Source Serif Pro Regular, whose outlines are cubic; the em is 1.
fn letters() -> Vec<Cubic> {
    let file = package("source-serif-pro").join("OTF/SourceSerifPro-Regular.otf");
    let bytes = std::fs::read(file).expect("a typeface");
    let face = ttf_parser::Face::parse(&bytes, 0).expect("a typeface");
    let em = f64::from(face.units_per_em());
    let mut found = Vec::new();
    for glyph in (0..face.number_of_glyphs()).step_by(3) {
        let mut outline = Outline(BezPath::new());
        if face.outline_glyph(ttf_parser::GlyphId(glyph), &mut outline).is_some() {
            found.extend(curves_of(&outline.0, em));
        }
    }
    found
}
