//! The command line: names, values and their help.
use crate::require::Requirement;
use chordal::budget::{InvalidLength, Length, Pixels, RequiredEvidence, Unit, View};
use chordal::math::Box3;
use chordal_io::{Axis, Format, PolygonSurface};
use chordal_verbs::Normals;
use clap::{ArgGroup, Args, Parser, Subcommand, ValueEnum};
use clap_complete::Shell;
use std::net::IpAddr;
use std::path::PathBuf;

/// You bring a budget, you leave with a bound.
///
/// Turns shapes into triangles under one budget, the error that may be seen, in units or in pixels, and says how
/// large the error is and how that is known.
#[derive(Debug, Parser)]
#[command(name = "chordal", version, max_term_width = 100, after_long_help = EXIT_CODES)]
pub struct Cli {
    /// What to do
    #[command(subcommand)]
    pub verb: Verb,
}

const EXIT_CODES: &str = "\
Exit codes:
    0  done
    1  a check failed
    2  the command line makes no sense
    3  the input cannot be read or is not supported
    4  the output cannot be written
    5  the budget was not reached, or cannot be
  130  interrupted

Messages go to stderr, data to stdout. '-' is stdin or stdout. Colours obey NO_COLOR.";

/// One word for each thing that can be done.
#[derive(Debug, Subcommand)]
pub enum Verb {
    /// Turn any shape into triangles, or curves into polylines, within a budget
    Mesh(MeshArgs),
    /// Make levels of detail, each with its own proved error, as one .glb or as a folder of 3D Tiles
    Lod(crate::lod::LodArgs),
    /// Say what a file holds and whether it is sound
    Inspect(InspectArgs),
    /// Say how far two shapes are apart, proved from both sides
    Deviation(crate::deviation::DeviationArgs),
    /// Take away what `inspect` found, and say what was changed
    Mend(crate::mend::MendArgs),
    /// Sample the distance to triangles on a lattice, negative inside
    Bake(crate::bake::BakeArgs),
    /// Take a picture
    Render(RenderArgs),
    /// Show in a browser how many segments a curve needs until it looks smooth
    Studio(StudioArgs),
    /// Print the completions of a shell
    Completions {
        /// Which shell
        shell: Shell,
    },
    /// Write the manual pages
    Man {
        /// The folder for them; it is made if it is missing
        #[arg(short, long, value_name = "DIR")]
        output: PathBuf,
    },
}

/// Arguments that every verb with an input takes.
#[derive(Args, Clone, Debug)]
pub struct InputArgs {
    /// The file to read; '-' reads stdin
    #[arg(value_name = "IN")]
    pub input: PathBuf,

    /// The format of the input, instead of what its name or content says
    #[arg(long, value_name = "FORMAT")]
    pub from: Option<Format>,

    /// The unit of the input's coordinates: um, mm, cm, m, km, in or ft
    #[arg(long, value_name = "UNIT")]
    pub unit: Option<Unit>,

    /// The axis of the input that is up
    #[arg(long, value_name = "AXIS", value_parser = axis)]
    pub up: Option<Axis>,

    /// The most memory that a job may take, as in 512M or 8G; half of what the machine or its control group has unless
    /// said. A file may take no more, and 4 GiB at most
    #[arg(long, value_name = "BYTES", value_parser = bytes)]
    pub max_memory: Option<u64>,

    /// For a file of several volumes (.nii, .nrrd): the one to read, counted from 0
    #[arg(long, value_name = "N")]
    pub index: Option<u64>,

    /// For a shape script: what one of its parameters is, as in r=0.5; may be given several times
    #[arg(long = "set", value_name = "NAME=VALUE", value_parser = setting, allow_hyphen_values = true)]
    pub set: Vec<(String, f64)>,

    /// For a field: the box that it is cut off at, as in "-1,-1,-1 1,1,1"
    #[arg(long, value_name = "BOX", value_parser = region, allow_hyphen_values = true)]
    pub region: Option<Box3>,

    /// What the polygons of an .obj stand for; unless said, catmull-clark where the file has subdivision tags, else faceted
    #[arg(long, value_name = "WHICH")]
    pub surface: Option<PolygonSurfaceArg>,

    /// Only warn of what is wrong in a glTF file without touching its geometry, and of bytes after a volume
    #[arg(long)]
    pub lenient: bool,

    /// Drop vertices that are not finite numbers, with their faces, and count them, instead of refusing the file
    #[arg(long)]
    pub drop_nonfinite: bool,
}

/// Which surface polygons stand for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum PolygonSurfaceArg {
    /// The limit of Catmull-Clark subdivision
    CatmullClark,
    /// The limit of Loop subdivision, of triangles
    Loop,
    /// Each quad bilinear, each other polygon cut into quads
    Bilinear,
    /// The polygons as they are, cut into triangles
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
pub struct ConsoleArgs {
    /// Print one report object on stdout
    #[arg(long)]
    pub json: bool,

    /// Say nothing but errors
    #[arg(short, long, conflicts_with = "verbose")]
    pub quiet: bool,

    /// Say more
    #[arg(short, long)]
    pub verbose: bool,
}

/// Arguments of verbs that write a file.
#[derive(Args, Debug)]
pub struct OutputArgs {
    /// The file to write; '-' writes to stdout
    #[arg(short, long, value_name = "OUT")]
    pub output: PathBuf,

    /// Replace the output if it exists
    #[arg(long)]
    pub force: bool,

    /// Threads to use; 0 means all. The result does not depend on it
    #[arg(long, value_name = "N", default_value_t = 0)]
    pub threads: usize,
}

/// `chordal mesh`
#[derive(Args, Debug)]
#[command(group = ArgGroup::new("budget").args(["tol", "px", "triangles", "segments"]).multiple(true))]
#[command(after_help = "\
Examples:
  chordal mesh teapot.bpt --tol 0.001 -o teapot.obj
  chordal mesh teapot.bpt --px 1 --view \"1920x1080 fov=45 dist=4\" -o teapot.glb
  chordal mesh teapot.bpt --triangles 5000 -o teapot.stl
  chordal mesh drawing.svg --tol 0.25 -o drawing.json
  chordal mesh drawing.svg --tol 0.25 -o drawing.glb
  chordal mesh brain.nii.gz --iso 60 -o brain.glb
  chordal mesh organs.nii.gz --labels all -o organs.glb
  chordal mesh cage.obj --level 2 -o refined.obj")]
pub struct MeshArgs {
    #[command(flatten)]
    pub input: InputArgs,

    #[command(flatten)]
    pub output: OutputArgs,

    /// The format of the output, instead of what its name says
    #[arg(long, value_name = "FORMAT")]
    pub to: Option<Format>,

    /// The largest distance to the true shape: 0.1, 0.1mm, or 0.05% of the diagonal of its box
    #[arg(long, value_name = "LENGTH", value_parser = length, allow_hyphen_values = true)]
    pub tol: Option<Length>,

    /// The largest distance on the screen of --view, in device pixels
    #[arg(long, value_name = "PIXELS", allow_hyphen_values = true)]
    pub px: Option<Pixels>,

    /// From where the shape is seen: "1920x1080 fov=45 dist=4" for every direction at that distance from its box or
    /// more, "1920x1080 fov=45 eye=1,2,3 target=0,0,0" for one eye; height=LENGTH instead of fov for parallel rays
    #[arg(long, value_name = "VIEW")]
    pub view: Option<View>,

    /// For smooth surfaces, beside one of the others: the largest angle between the normals of the triangles and those of the shape, as in 5deg
    #[arg(long, value_name = "ANGLE", value_parser = angle, requires = "budget", allow_hyphen_values = true)]
    pub angle: Option<f64>,

    /// The most triangles: the best mesh with no more than these
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(1..), allow_hyphen_values = true)]
    pub triangles: Option<u64>,

    /// For curves to polylines (.svg, .json): the most segments, all together
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(1..), allow_hyphen_values = true)]
    pub segments: Option<u64>,

    /// For curves: as few segments as the budget allows, or equal steps of each piece's parameter
    #[arg(long, value_name = "HOW", default_value = "fewest")]
    pub spacing: SpacingArg,

    /// Normals of triangles: what the shape has and, for glb and obj, crease=30deg where it has none (auto); keep, none
    /// are added; flat; smooth; crease=ANGLE, smooth up to that angle; groups, by the smoothing groups of an .obj
    #[arg(long, value_name = "HOW", default_value = "auto")]
    pub normals: Normals,

    /// For a polygon cage (.obj): write its polygons after N rounds of refinement instead of its smooth surface; 0 keeps them
    #[arg(long, value_name = "N", conflicts_with = "budget")]
    pub level: Option<u32>,

    #[command(flatten)]
    pub volume: crate::volume::VolumeArgs,

    /// How a field's distance is known: proved, or measured, which is sooner there. Unless said, proved where there is anything to
    /// prove with. Other shapes are proved either way
    #[arg(long, value_name = "EVIDENCE")]
    pub require: Option<RequiredEvidence>,

    /// Write the best result even where the budget was not reached; the exit code is 5 all the same
    #[arg(long)]
    pub keep_best: bool,

    #[command(flatten)]
    pub console: ConsoleArgs,
}

/// How the ends of segments are placed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum SpacingArg {
    /// Nearly as few segments as can be
    Fewest,
    /// Equal steps of the parameter
    Even,
}

/// `chordal inspect`
#[derive(Args, Debug)]
#[command(after_help = "\
Examples:
  chordal inspect part.stl
  chordal inspect part.stl --self-intersections
  chordal inspect part.stl --require solid")]
pub struct InspectArgs {
    #[command(flatten)]
    pub input: InputArgs,

    /// Fail with exit code 1 unless the mesh is all of these
    #[arg(long, value_name = "WHAT", value_delimiter = ',')]
    pub require: Vec<Requirement>,

    /// Look for triangles that cross, overlap or touch where they should not: exact, and some seconds for some million
    #[arg(long)]
    pub self_intersections: bool,

    #[command(flatten)]
    pub console: ConsoleArgs,
}

/// `chordal render`
#[derive(Args, Debug)]
pub struct RenderArgs {
    #[command(flatten)]
    pub input: InputArgs,

    #[command(flatten)]
    pub output: OutputArgs,

    /// What the picture shows
    #[arg(long, value_name = "WHAT", default_value = "shaded")]
    pub show: RenderMode,

    /// For --show deviation: the shape that the distance is measured from
    #[arg(long, value_name = "FILE")]
    pub against: Option<PathBuf>,

    /// For --show deviation: the distance that is darkest; the largest one unless said
    #[arg(long, value_name = "LENGTH", value_parser = length, requires = "against")]
    pub darkest: Option<Length>,

    /// Which sides of triangles are left out, as graphics processors do
    #[arg(long, value_name = "SIDES", default_value = "none")]
    pub cull: crate::render::CullArg,

    /// The size of the picture
    #[arg(long, value_name = "WxH", value_parser = size, conflicts_with = "view", allow_hyphen_values = true)]
    pub size: Option<[u32; 2]>,

    /// The camera, with the size of the picture: "1280x960 fov=30 eye=4,-6,3 target=0,0,1"
    #[arg(long, value_name = "VIEW")]
    pub view: Option<View>,

    /// For smooth shapes: the largest distance to the true shape
    #[arg(long, value_name = "LENGTH", value_parser = length, allow_hyphen_values = true)]
    pub tol: Option<Length>,

    /// For smooth shapes: the largest distance in the picture, in pixels; half a pixel if nothing is said
    #[arg(long, value_name = "PIXELS", allow_hyphen_values = true, conflicts_with = "tol")]
    pub px: Option<Pixels>,

    #[command(flatten)]
    pub console: ConsoleArgs,
}

/// `chordal studio`
#[derive(Args, Debug)]
#[command(after_help = "\
Examples:
  chordal studio
  chordal studio --port 8000 --open
  chordal studio --host 0.0.0.0 --allow-host lab.example --token $(openssl rand -hex 24)")]
pub struct StudioArgs {
    /// The port to listen at; 0 takes a free one
    #[arg(long, value_name = "PORT", default_value_t = 0)]
    pub port: u16,

    /// The address to listen at, instead of 127.0.0.1; other machines can come in where it is none of this machine's
    /// own, so that needs --token as well
    #[arg(long, value_name = "ADDRESS")]
    pub host: Option<IpAddr>,

    /// The token in the link, instead of one made by chance: 32 letters and digits or more
    #[arg(long, value_name = "TOKEN")]
    pub token: Option<String>,

    /// A name by which browsers may call this machine, beside localhost, 127.0.0.1 and [::1]
    #[arg(long, value_name = "NAME")]
    pub allow_host: Vec<String>,

    /// The folder of the page, instead of the one that is built in
    #[arg(long, value_name = "DIR")]
    pub dir: Option<PathBuf>,

    /// Open the link in the system's browser
    #[arg(long)]
    pub open: bool,
}

/// What a picture can show.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum RenderMode {
    /// Light on the surface, with the file's normals where it has some
    Shaded,
    /// Light on the triangles
    Flat,
    /// The triangles' edges
    Wire,
    /// The direction of the normal as a colour
    Normals,
    /// Stripes as the surface mirrors them: kinks in its curvature show as kinks
    Zebra,
    /// How many lanes a graphics processor launches for each pixel, from light for one to dark for 16 and more; the report
    /// counts quads, helper lanes, triangles too small to be seen, and flicker
    Overshade,
    /// The distance from the shape of --against as a colour, from light through yellow and red to dark
    Deviation,
}

/// The reason alone: the message that it becomes part of names the text already.
pub(crate) fn length(text: &str) -> Result<Length, String> {
    text.parse().map_err(|error: InvalidLength| {
        let said = error.to_string();
        said.strip_prefix(&format!("'{}': ", text.trim())).unwrap_or(&said).to_owned()
    })
}

fn angle(text: &str) -> Result<f64, String> {
    let number = text.strip_suffix("deg").unwrap_or(text).trim().parse();
    match number {
        Ok(angle) if angle > 0.0 && angle <= 180.0 => Ok(angle),
        _ => Err("an angle is above 0 and at most 180 degrees, as in 5deg".into()),
    }
}

fn axis(text: &str) -> Result<Axis, String> {
    match text {
        "y" | "Y" => Ok(Axis::Y),
        "z" | "Z" => Ok(Axis::Z),
        _ => Err("the axis that is up is y or z".into()),
    }
}

fn size(text: &str) -> Result<[u32; 2], String> {
    let wrong = || "a size reads like 1280x960".to_owned();
    let (width, height) = text.split_once('x').ok_or_else(wrong)?;
    let size = [width.parse().map_err(|_| wrong())?, height.parse().map_err(|_| wrong())?];
    if size.contains(&0) { Err("a picture is at least 1x1 pixels".into()) } else { Ok(size) }
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
fn bytes(text: &str) -> Result<u64, String> {
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
    use clap::CommandFactory;

    #[test]
    fn the_command_line_holds_together() {
        Cli::command().debug_assert();
    }

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

    #[test]
    fn reads_the_size_of_a_picture() {
        assert_eq!(size("640x480"), Ok([640, 480]));
        for text in ["", "640", "640x", "0x1", "1x1x1", "-1x5"] {
            assert!(size(text).is_err(), "{text}");
        }
    }
}
