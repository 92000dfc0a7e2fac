//! `Keywords`: settings in the spelling of Python, as arguments.
use chordal::budget::advice::{Setting, Spelling};
use chordal_cli::spelling::CommandLine;

/// Settings as arguments and functions of the package, or as options of the command if the package has none.
pub(crate) struct Keywords;

impl Spelling for Keywords {
    fn spell(&self, setting: Setting, value: Option<&str>) -> String {
        let number = |name: &str| format!("{name}={}", value.unwrap_or_default());
        let text = |name: &str| value.map_or_else(|| format!("{name}="), |text| format!("{name}=\"{text}\""));
        match setting {
            Setting::Unit => text("unit"),
            Setting::From => text("format"),
            Setting::Surface => text("surface"),
            Setting::Lenient => "lenient=True".to_owned(),
            Setting::Region => "within()".to_owned(),
            Setting::Iso => number("iso"),
            Setting::Labels => number("labels"),
            Setting::Smooth => text("smooth"),
            Setting::Open => "border=\"open\"".to_owned(),
            Setting::UvError => number("uv_error"),
            Setting::NormalError => number("normal_error"),
            Setting::Tol => number("tol"),
            Setting::Px => number("pixels"),
            Setting::View => text("view"),
            Setting::Nearest => number("nearest"),
            Setting::Triangles => number("triangles"),
            Setting::Segments => number("segments"),
            Setting::Compress => text("compress"),
            Setting::Quantize => "quantize=True".to_owned(),
            Setting::Effort => text("effort"),
            Setting::Nested => text("nested"),
            Setting::Cure(cure) => {
                let named = cure.name().replace('-', "_");
                let value = value.map_or_else(|| "True".to_owned(), |length| format!("\"{length}\""));
                format!("mend({named}={value})")
            }
            Setting::Level => "Cage.refined".to_owned(),
            Setting::Index => match value {
                Some(_) => number("index"),
                None => "index=".to_owned(),
            },
            Setting::Text | Setting::TileTriangles | Setting::MaxMemory | Setting::SelfIntersections => {
                format!("{} of the command", CommandLine.spell(setting, value))
            }
        }
    }
}
