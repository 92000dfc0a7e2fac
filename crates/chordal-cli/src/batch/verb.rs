//! The verbs that a batch can run, and the formats of their outputs.
use crate::fault::Fault;
use chordal_io::{Format, PictureFormat};
use chordal_verbs::extension;
use chordal_verbs::formats::{in_words, names_where};
use clap::ValueEnum;
use std::path::Path;

/// A verb that reads one file and writes one.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum BatchVerb {
    /// Triangles or polylines; .glb unless --to says otherwise
    Mesh,
    /// Levels of detail; .glb
    Lod,
    /// Repaired triangles; in the format of the input, or .glb
    Mend,
    /// Distances on a grid; .nrrd
    Bake,
    /// Pictures; .png unless --to says otherwise
    Render,
    /// The same shapes; .glb
    Convert,
    /// Reports; .json
    Inspect,
}

impl BatchVerb {
    /// The name on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Self::Mesh => "mesh",
            Self::Lod => "lod",
            Self::Mend => "mend",
            Self::Bake => "bake",
            Self::Render => "render",
            Self::Convert => "convert",
            Self::Inspect => "inspect",
        }
    }

    /// Whether the result is a report.
    pub fn is_report(self) -> bool {
        self == Self::Inspect
    }

    /// The extension of the output for an input, without `--to`.
    pub fn usual_extension(self, input: &Path) -> String {
        match self {
            Self::Mesh | Self::Lod | Self::Convert => "glb".to_owned(),
            Self::Bake => "nrrd".to_owned(),
            Self::Render => "png".to_owned(),
            Self::Inspect => "json".to_owned(),
            Self::Mend => {
                let name = input.to_string_lossy();
                let format = extension(&name).and_then(Format::from_packed_extension);
                format.filter(|format| format.holds_triangles()).unwrap_or(Format::Glb).to_string()
            }
        }
    }

    /// The extension for a value of `--to`.
    ///
    /// # Errors
    /// If the verb does not write that format.
    pub fn extension_for(self, to: &str) -> Result<String, Fault> {
        let name = self.name();
        let refuse = |formats: &str| Err(Fault::usage(format!("--to {to}: {name} writes {formats}")));
        let format = to.parse::<Format>().ok();
        let is_held = |holds: &[fn(Format) -> bool]| {
            format.filter(|format| holds.iter().any(|holds| holds(*format))).map(|format| format.to_string())
        };
        let mesh: [fn(Format) -> bool; 3] =
            [Format::holds_triangles, Format::holds_polylines, Format::holds_volumes];
        let lower = to.trim_start_matches('.').to_ascii_lowercase();
        let (extension, formats) = match self {
            Self::Render => {
                let known = PictureFormat::from_extension(&lower);
                return if known.is_some() { Ok(lower) } else { refuse("png, jpg and webp") };
            }
            Self::Inspect => return if lower == "json" { Ok(lower) } else { refuse("json") },
            Self::Lod => return if lower == "glb" { Ok(lower) } else { refuse("glb") },
            Self::Bake => (is_held(&mesh[2..]), in_words(&names_where(Format::holds_volumes), "and")),
            Self::Mesh => (is_held(&mesh[..2]), "formats of triangles and of polylines".to_owned()),
            Self::Mend => (is_held(&mesh[..1]), "formats of triangles".to_owned()),
            Self::Convert => (is_held(&mesh), "formats that can be written".to_owned()),
        };
        extension.map_or_else(|| refuse(&formats), Ok)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn outputs_have_extensions_that_their_verb_writes() {
        assert_eq!(BatchVerb::Mend.usual_extension(Path::new("a/b.STL")), "stl");
        assert_eq!(BatchVerb::Mend.usual_extension(Path::new("a.star")), "glb");
        assert_eq!(BatchVerb::Convert.extension_for(".PLY").ok().as_deref(), Some("ply"));
        assert_eq!(BatchVerb::Bake.extension_for("npy").ok().as_deref(), Some("npy"));
        assert_eq!(BatchVerb::Render.extension_for(".JPG").ok().as_deref(), Some("jpg"));
        for (verb, to) in [
            (BatchVerb::Bake, "obj"),
            (BatchVerb::Mesh, "nrrd"),
            (BatchVerb::Render, "gif"),
            (BatchVerb::Lod, "obj"),
            (BatchVerb::Convert, "nii"),
            (BatchVerb::Mend, "../x"),
        ] {
            assert!(verb.extension_for(to).is_err(), "{to}");
        }
    }
}
