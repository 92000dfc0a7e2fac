//! Arguments that several verbs share: input, output, report; and how their values are read.
use crate::memory;
use chordal::budget::attributes::AttributeLimits;
use chordal::budget::{InvalidLength, Length, Unit};
use chordal::math::Box3;
use chordal_io::font::Letters;
use chordal_io::{Axis, Format, PolygonSurface};
use clap::{Args, ValueEnum};
use std::path::PathBuf;

/// Arguments that every verb with an input takes.
#[derive(Args, Clone, Debug)]
#[command(next_help_heading = "Input")]
pub struct InputArgs {
    /// Input file; '-' reads stdin
    #[arg(value_name = "IN", index = 1, help_heading = None::<&str>)]
    pub input: PathBuf,

    /// Input format, if not the one that the file's name or content implies
    #[arg(long, value_name = "FORMAT")]
    pub from: Option<Format>,

    /// Which level of detail of a glTF, of which the finest is 0; `verify` alone reads others.
    #[arg(skip)]
    pub level: usize,

    /// Unit of the input's coordinates: um, mm, cm, m, km, in or ft
    #[arg(long, value_name = "UNIT")]
    pub unit: Option<Unit>,

    /// Up axis of the input: y or z
    #[arg(long, value_name = "AXIS", value_parser = axis)]
    pub up: Option<Axis>,

    /// Maximum memory, e.g. 512M or 8G. Default: half of the machine's or its control group's. An input file may
    /// be no larger than that, nor than 4 GiB
    #[arg(long, value_name = "BYTES", value_parser = bytes)]
    pub max_memory: Option<u64>,

    /// For a file with several volumes, arrays or fonts: which one to read, counted from 0
    #[arg(long, value_name = "N")]
    pub index: Option<u64>,

    /// For a shape script: the value of a parameter, e.g. r=0.5; repeatable
    #[arg(long = "set", value_name = "NAME=VALUE", value_parser = setting, allow_hyphen_values = true)]
    pub set: Vec<(String, f64)>,

    /// For a font: the text to set; line breaks start new lines
    #[arg(long, value_name = "TEXT", allow_hyphen_values = true)]
    pub text: Option<String>,

    /// For a font: the em size, of which capitals are about 0.7 high. Default: 1
    #[arg(long, value_name = "LENGTH", requires = "text", allow_hyphen_values = true)]
    pub em: Option<f64>,

    /// For a variable font: the position on an axis, e.g. wght=700; repeatable
    #[arg(long = "axis", value_name = "TAG=VALUE", value_parser = setting, requires = "text", allow_hyphen_values = true)]
    pub axes: Vec<(String, f64)>,

    /// For a shape script: a folder that it may read meshes from, besides its own; repeatable
    #[arg(long, value_name = "FOLDER")]
    pub allow: Vec<PathBuf>,

    /// For a field: the box to clip it to, e.g. "-1,-1,-1 1,1,1"
    #[arg(long, value_name = "BOX", value_parser = region, allow_hyphen_values = true)]
    pub region: Option<Box3>,

    /// What the polygons of an .obj represent. Default: catmull-clark if the file has subdivision tags, else
    /// faceted
    #[arg(long, value_name = "WHICH")]
    pub surface: Option<PolygonSurfaceArg>,

    /// Reject a glTF file for anything that the Khronos validator calls an error, even if viewers accept it,
    /// and an .obj whose faces use normals or texture coordinates that it does not define
    #[arg(long, conflicts_with = "lenient")]
    pub strict: bool,

    /// Only warn about errors in a glTF file that do not affect its geometry, and about extra bytes after a
    /// volume
    #[arg(long)]
    pub lenient: bool,

    /// Drop vertices with infinite or NaN coordinates, and their faces, and count them, instead of rejecting
    /// the file
    #[arg(long)]
    pub drop_nonfinite: bool,
}

impl InputArgs {
    /// What a font is to set.
    pub fn letters(&self) -> Option<Letters> {
        let text = self.text.as_deref()?;
        Some(Letters { em: self.em.unwrap_or(1.0), axes: self.axes.clone(), ..Letters::new(text) })
    }

    /// The most memory: what was said, else a share of what there is.
    pub fn memory_limit(&self) -> Option<u64> {
        self.max_memory.or_else(memory::default_limit)
    }
}

/// Which surface polygons stand for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum PolygonSurfaceArg {
    /// The limit surface of Catmull-Clark subdivision
    CatmullClark,
    /// The limit surface of Loop subdivision, for triangles
    Loop,
    /// Bilinear quads; other polygons are split into quads first
    Bilinear,
    /// The polygons as they are, split into triangles
    Faceted,
}

impl From<PolygonSurfaceArg> for PolygonSurface {
    fn from(surface: PolygonSurfaceArg) -> Self {
        match surface {
            PolygonSurfaceArg::CatmullClark => Self::CatmullClark,
            PolygonSurfaceArg::Loop => Self::Loop,
            PolygonSurfaceArg::Bilinear => Self::Bilinear,
            PolygonSurfaceArg::Faceted => Self::Faceted,
        }
    }
}

/// Arguments about what is said while working and afterwards.
#[derive(Args, Debug)]
#[command(next_help_heading = "Report")]
pub struct ConsoleArgs {
    /// Print the report on stdout, as one JSON object
    #[arg(long)]
    pub json: bool,

    /// Print errors only
    #[arg(short, long, conflicts_with = "verbose")]
    pub quiet: bool,

    /// Print more
    #[arg(short, long)]
    pub verbose: bool,
}

/// Arguments of verbs that write a file.
#[derive(Args, Debug)]
#[command(next_help_heading = "Output")]
pub struct OutputArgs {
    /// Output file; '-' writes to stdout
    #[arg(short, long, value_name = "OUT")]
    pub output: PathBuf,

    /// Overwrite the output if it exists
    #[arg(long)]
    pub force: bool,

    /// Number of threads; 0 uses all. The result does not depend on it
    #[arg(long, value_name = "N", default_value_t = 0)]
    pub threads: usize,
}

/// What attributes of triangles may lose, beside a length or pixels.
#[derive(Args, Clone, Copy, Debug)]
#[command(next_help_heading = "Budget")]
pub struct AttributeArgs {
    /// For triangles with texture coordinates, with a length or pixels: maximum distance to the input's, 0.01
    /// or 1% of the texture's side. Measured
    #[arg(long, value_name = "DISTANCE", value_parser = texcoord_distance, allow_hyphen_values = true)]
    pub uv_error: Option<f64>,

    /// For triangles with normals, with a length or pixels: maximum angle to the input's, e.g. 10deg.
    /// Measured; flat shading follows the faces
    #[arg(long, value_name = "ANGLE", value_parser = angle, allow_hyphen_values = true)]
    pub normal_error: Option<f64>,
}

impl AttributeArgs {
    /// The limits, which the parsers have accepted.
    pub fn limits(self) -> AttributeLimits {
        AttributeLimits::new(self.uv_error, self.normal_error).unwrap_or_default()
    }
}

fn texcoord_distance(text: &str) -> Result<f64, String> {
    let (number, unit) = text.trim().strip_suffix('%').map_or((text.trim(), 1.0), |share| (share, 0.01));
    match number.trim().parse::<f64>().map(|number| number * unit) {
        Ok(distance) if AttributeLimits::new(Some(distance), None).is_ok() => Ok(distance),
        _ => Err("a distance of texture coordinates is above 0, as in 0.01 or 1%".into()),
    }
}

/// An angle in degrees.
pub(crate) fn angle(text: &str) -> Result<f64, String> {
    let number = text.strip_suffix("deg").unwrap_or(text).trim().parse();
    match number {
        Ok(angle) if angle > 0.0 && angle <= 180.0 => Ok(angle),
        _ => Err("an angle is above 0 and at most 180 degrees, as in 5deg".into()),
    }
}

/// The reason alone: the message that it becomes part of names the text already.
pub(crate) fn length(text: &str) -> Result<Length, String> {
    text.parse().map_err(|error: InvalidLength| {
        let said = error.to_string();
        said.strip_prefix(&format!("'{}': ", text.trim())).unwrap_or(&said).to_owned()
    })
}

fn axis(text: &str) -> Result<Axis, String> {
    match text {
        "y" | "Y" => Ok(Axis::Y),
        "z" | "Z" => Ok(Axis::Z),
        _ => Err("the axis that is up is y or z".into()),
    }
}

/// `r=0.5`
fn setting(text: &str) -> Result<(String, f64), String> {
    let wrong = || format!("a setting reads like r=0.5, not '{text}'");
    let (name, value) = text.split_once('=').ok_or_else(wrong)?;
    let value = value.trim().parse().ok().filter(|value: &f64| value.is_finite()).ok_or_else(wrong)?;
    Ok((name.trim().to_owned(), value))
}

/// `-1,-1,-1 1,1,1`
fn region(text: &str) -> Result<Box3, String> {
    let wrong = || "a box reads like \"-1,-1,-1 1,1,1\", its lowest corner first".to_owned();
    let corner = |text: &str| -> Option<[f64; 3]> {
        let numbers: Option<Vec<f64>> = text.split(',').map(|number| number.trim().parse().ok()).collect();
        numbers?.try_into().ok()
    };
    let (low, high) = text.trim().split_once(char::is_whitespace).ok_or_else(wrong)?;
    let (min, max) = (corner(low.trim()).ok_or_else(wrong)?, corner(high.trim()).ok_or_else(wrong)?);
    let sound = (0..3).all(|k| min[k] < max[k] && min[k].is_finite() && max[k].is_finite());
    if sound { Ok(Box3 { min, max }) } else { Err(wrong()) }
}

/// `512M`, `8G`, `1000000`: powers of 1024, as memory comes.
pub(crate) fn bytes(text: &str) -> Result<u64, String> {
    let wrong = || format!("a number of bytes reads like 512M or 8G, not '{text}'");
    let digits = text.trim_end_matches(|c: char| c.is_ascii_alphabetic());
    let power = match &text[digits.len()..].to_ascii_uppercase()[..] {
        "" | "B" => 0,
        "K" | "KB" | "KIB" => 1,
        "M" | "MB" | "MIB" => 2,
        "G" | "GB" | "GIB" => 3,
        "T" | "TB" | "TIB" => 4,
        _ => return Err(wrong()),
    };
    let number: u64 = digits.parse().map_err(|_| wrong())?;
    number.checked_mul(1 << (10 * power)).filter(|bytes| *bytes > 0).ok_or_else(wrong)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn reads_a_number_of_bytes() {
        assert_eq!(bytes("12"), Ok(12));
        assert_eq!(bytes("3k"), Ok(3072));
        assert_eq!(bytes("8GiB"), Ok(8 << 30));
        for text in ["", "G", "1X", "-1", "1.5G", "0", "99999999999T", "1é"] {
            assert!(bytes(text).is_err(), "{text}");
        }
    }

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
}
