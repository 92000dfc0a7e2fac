//! `ReadOptions`: how an input is read, as far as its bytes do not say it themselves.
use super::values::{count_from_0, word};
use super::{OptionRow, OptionSection, OptionTable, OptionValues, store_some};
use chordal::budget::Unit;
use chordal::explicit::subdivision::Scheme;
use chordal::math::Box3;
use chordal_io::font::Letters;
use chordal_io::{Axis, Conformance, Format, Frame, Limits, PolygonSurface};

/// How an input is read.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ReadOptions {
    /// The format, overriding name and content.
    pub from: Option<Format>,
    /// The unit of its coordinates.
    pub unit: Option<Unit>,
    /// Its up axis.
    pub up: Option<Axis>,
    /// Which volume, array or font of several, counted from 0.
    pub index: Option<u64>,
    /// Values for the parameters of a shape script.
    pub set: Vec<(String, f64)>,
    /// The text that a font sets.
    pub text: Option<String>,
    /// The size of its em.
    pub em: Option<f64>,
    /// Positions on the axes of a variable font.
    pub axes: Vec<(String, f64)>,
    /// The box that a field is clipped to.
    pub region: Option<Box3>,
    /// What the polygons of an `.obj` represent.
    pub surface: Option<PolygonSurface>,
    /// Which errors that do not touch the geometry are warnings.
    pub conformance: Conformance,
    /// Whether vertices that are not finite are dropped.
    pub drop_nonfinite: bool,
}

impl ReadOptions {
    /// The text that a font is to set, if there is one.
    #[must_use]
    pub fn letters(&self) -> Option<Letters> {
        let text = self.text.as_deref()?;
        Some(Letters { em: self.em.unwrap_or(1.0), axes: self.axes.clone(), ..Letters::new(text) })
    }

    /// The limits of a reader, as far as options set them.
    #[must_use]
    pub fn limits(&self, others: Limits) -> Limits {
        Limits {
            conformance: self.conformance,
            drop_nonfinite: self.drop_nonfinite,
            index: self.index,
            surface: self.surface,
            ..others
        }
    }

    /// Sets what the user knows of the input's frame.
    pub fn complete(&self, frame: &mut Frame) {
        frame.metres_per_unit = self.unit.map(Unit::metres).or(frame.metres_per_unit);
        frame.up = self.up.or(frame.up);
    }
}

/// The limit surface of each scheme, and the polygons themselves.
const SURFACES: OptionValues = OptionValues::Words(&SURFACE_WORDS);
const SURFACE_WORDS: [(&str, &str); Scheme::ALL.len() + 1] = {
    let mut words = [(FACETED, "The polygons as they are, split into triangles"); Scheme::ALL.len() + 1];
    let mut k = 0;
    while k < Scheme::ALL.len() {
        words[k] = (Scheme::ALL[k].name(), scheme_help(Scheme::ALL[k]));
        k += 1;
    }
    words
};
const FACETED: &str = "faceted";

const fn scheme_help(scheme: Scheme) -> &'static str {
    match scheme {
        Scheme::CatmullClark => "The limit surface of Catmull-Clark subdivision",
        Scheme::Loop => "The limit surface of Loop subdivision, for triangles",
        Scheme::Bilinear => "Bilinear quads; other polygons are split into quads first",
    }
}

impl OptionTable for ReadOptions {
    const ROWS: &'static [OptionRow<Self>] = &[
        OptionRow::<Self>::new(
            "from",
            (OptionValues::Text, "FORMAT"),
            "Input format, if not the one that the file's name or content implies",
            |options, text| store_some(&mut options.from, text.parse()),
        )
        .renamed("format")
        .under(OptionSection::Input),
        OptionRow::<Self>::new(
            "unit",
            (OptionValues::Text, "UNIT"),
            "Unit of the input's coordinates: um, mm, cm, m, km, in or ft",
            |options, text| store_some(&mut options.unit, text.parse()),
        )
        .under(OptionSection::Input),
        OptionRow::<Self>::new(
            "up",
            (OptionValues::Text, "AXIS"),
            "Up axis of the input: y or z",
            |options, text| store_some(&mut options.up, axis(text)),
        )
        .under(OptionSection::Input),
        OptionRow::<Self>::new(
            "index",
            (OptionValues::Count, "N"),
            "For a file with several volumes, arrays or fonts: which one to read, counted from 0",
            |options, text| store_some(&mut options.index, count_from_0(text)),
        )
        .under(OptionSection::Input),
        OptionRow::<Self>::new(
            "set",
            (OptionValues::Text, "NAME=VALUE"),
            "For a shape script: the value of a parameter, e.g. r=0.5; repeatable",
            |options, text| {
                options.set.push(setting(text)?);
                Ok(())
            },
        )
        .repeatable()
        .under(OptionSection::Input)
        .without_keyword(),
        OptionRow::<Self>::new(
            "text",
            (OptionValues::Text, "TEXT"),
            "For a font: the text to set; line breaks start new lines",
            |options, text| {
                options.text = Some(text.to_owned());
                Ok(())
            },
        )
        .under(OptionSection::Input),
        OptionRow::<Self>::new(
            "em",
            (OptionValues::Number, "LENGTH"),
            "For a font: the em size, of which capitals are about 0.7 high. Default: 1",
            |options, text| store_some(&mut options.em, text.parse::<f64>()),
        )
        .needs("text")
        .under(OptionSection::Input),
        OptionRow::<Self>::new(
            "axis",
            (OptionValues::Text, "TAG=VALUE"),
            "For a variable font: the position on an axis, e.g. wght=700; repeatable",
            |options, text| {
                options.axes.push(setting(text)?);
                Ok(())
            },
        )
        .renamed("axes")
        .repeatable()
        .needs("text")
        .under(OptionSection::Input),
        OptionRow::<Self>::new(
            "region",
            (OptionValues::Text, "BOX"),
            "For a field: the box to clip it to, e.g. \"-1,-1,-1 1,1,1\"",
            |options, text| store_some(&mut options.region, region(text)),
        )
        .under(OptionSection::Input)
        .without_keyword(),
        OptionRow::<Self>::new(
            "surface",
            (SURFACES, "WHICH"),
            "What the polygons of an .obj represent. Default: catmull-clark if the file has subdivision tags, else faceted",
            |options, text| store_some(&mut options.surface, polygon_surface(text)),
        )
        .under(OptionSection::Input),
        OptionRow::<Self>::flag(
            "strict",
            "Reject a glTF file for anything that the Khronos validator calls an error, even if viewers accept it, and an \
             .obj whose faces use normals or texture coordinates that it does not define",
            |options, _| {
                options.conformance = Conformance::Strict;
                Ok(())
            },
        )
        .conflicts(&["lenient"])
        .under(OptionSection::Input),
        OptionRow::<Self>::flag(
            "lenient",
            "Only warn about errors in a glTF file that do not affect its geometry, and about extra bytes after a volume",
            |options, _| {
                options.conformance = Conformance::Lenient;
                Ok(())
            },
        )
        .under(OptionSection::Input),
        OptionRow::<Self>::flag(
            "drop-nonfinite",
            "Drop vertices with infinite or NaN coordinates, and their faces, and count them, instead of rejecting the file",
            |options, _| {
                options.drop_nonfinite = true;
                Ok(())
            },
        )
        .under(OptionSection::Input),
    ];
}

fn axis(text: &str) -> Result<Axis, &'static str> {
    match text {
        "y" | "Y" => Ok(Axis::Y),
        "z" | "Z" => Ok(Axis::Z),
        _ => Err("the axis that is up is y or z"),
    }
}

fn polygon_surface(text: &str) -> Result<PolygonSurface, String> {
    let limits = Scheme::ALL.into_iter().map(|scheme| (scheme.name(), PolygonSurface::Limit(scheme)));
    let surfaces: Vec<_> = limits.chain([(FACETED, PolygonSurface::Faceted)]).collect();
    word(text, &surfaces)
}

/// `r=0.5`
fn setting(text: &str) -> Result<(String, f64), String> {
    let wrong = || format!("a setting reads like r=0.5, not '{text}'");
    let (name, value) = text.split_once('=').ok_or_else(wrong)?;
    let value = value.trim().parse().ok().filter(|value: &f64| value.is_finite()).ok_or_else(wrong)?;
    Ok((name.trim().to_owned(), value))
}

/// `-1,-1,-1 1,1,1`
fn region(text: &str) -> Result<Box3, &'static str> {
    let wrong = "a box reads like \"-1,-1,-1 1,1,1\", its lowest corner first";
    let corner = |text: &str| -> Option<[f64; 3]> {
        let numbers: Option<Vec<f64>> = text.split(',').map(|number| number.trim().parse().ok()).collect();
        numbers?.try_into().ok()
    };
    let (low, high) = text.trim().split_once(char::is_whitespace).ok_or(wrong)?;
    let (min, max) = (corner(low.trim()).ok_or(wrong)?, corner(high.trim()).ok_or(wrong)?);
    let is_box = (0..3).all(|k| min[k] < max[k] && min[k].is_finite() && max[k].is_finite());
    if is_box { Ok(Box3 { min, max }) } else { Err(wrong) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn reads_settings_and_boxes() {
        assert_eq!(setting("r = -0.5"), Ok(("r".to_owned(), -0.5)));
        for text in ["", "r", "r=", "r=x", "r=inf"] {
            assert!(setting(text).is_err(), "{text}");
        }
        assert_eq!(region("-1,-2,-3 1,2,3"), Ok(Box3 { min: [-1.0, -2.0, -3.0], max: [1.0, 2.0, 3.0] }));
        for text in ["", "1", "0,0,0", "0,0 1,1", "0,0,0 1,1,0", "0,0,0 1,1,inf", "1,1,1 0,0,0"] {
            assert!(region(text).is_err(), "{text}");
        }
    }

    #[test]
    fn settings_add_up() {
        let mut options = ReadOptions::default();
        options.set("set", "r=1").expect("a setting");
        options.set("set", "h=2").expect("a setting");
        assert_eq!(options.set, [("r".to_owned(), 1.0), ("h".to_owned(), 2.0)]);
        assert!(options.letters().is_none());
        options.set("text", "Ab").expect("a text");
        assert_eq!(options.letters().map(|letters| letters.em), Some(1.0));
    }
}
