//! The format of an output, from `--to` or from its name.
use crate::fault::Fault;
use chordal_io::{ForeignFormat, Format};
use chordal_verbs::extension;
use chordal_verbs::formats::{self, in_words, names_where};
use std::path::Path;

/// The format of a mesh to write: `--to`, else that of the file extension.
pub fn output_format(path: &Path, to: Option<Format>) -> Result<Format, Fault> {
    let name = path.display().to_string();
    let by_name = || extension(&name).and_then(Format::from_extension);
    refuse_other_name(path, to)?;
    let names = formats::output_names;
    let format = to.or_else(by_name).ok_or_else(|| {
        refuse_foreign(&name, &names()).unwrap_or_else(|| {
            Fault::usage(format!(
                "{name}: the name does not tell the format; add --to with one of {}",
                names()
            ))
        })
    })?;
    if format.holds_triangles() || format.holds_polylines() {
        return Ok(format);
    }
    let why = if format.holds_volumes() { "holds samples only" } else { "can only be read" };
    Err(Fault::usage(format!("{format} {why}; formats that can be written are {}", names())))
}

/// The format to write, of any kind: `--to`, else that of the file extension.
pub fn writable_format(path: &Path, to: Option<Format>) -> Result<Format, Fault> {
    let name = path.display().to_string();
    let names = formats::writable_names;
    refuse_other_name(path, to)?;
    let format = to.or_else(|| extension(&name).and_then(Format::from_extension)).ok_or_else(|| {
        refuse_foreign(&name, &names()).unwrap_or_else(|| {
            Fault::usage(format!(
                "{name}: the name does not tell the format; add --to with one of {}",
                names()
            ))
        })
    })?;
    if format.holds_triangles() || format.holds_polylines() || format.holds_volumes() {
        return Ok(format);
    }
    Err(Fault::usage(format!("{format} can only be read; formats that can be written are {}", names())))
}

/// The format of a sampled volume: `--to`, else that of the file extension.
pub fn volume_format(path: &Path, to: Option<Format>) -> Result<Format, Fault> {
    let name = path.display().to_string();
    refuse_other_name(path, to)?;
    let format = to.or_else(|| extension(&name).and_then(Format::from_extension));
    let names = || names_where(Format::holds_volumes);
    match format {
        Some(format) if format.holds_volumes() => Ok(format),
        Some(other) => {
            Err(Fault::usage(format!("{other} holds no volume; {} do", in_words(&names(), "and"))))
        }
        None => Err(refuse_foreign(&name, &names().join(", ")).unwrap_or_else(|| {
            let names = in_words(&names(), "or");
            Fault::usage(format!("{name}: the name does not tell the format; add --to with {names}"))
        })),
    }
}

/// Refuses a file extension of another format than `--to`.
fn refuse_other_name(path: &Path, to: Option<Format>) -> Result<(), Fault> {
    let name = path.display().to_string();
    match (to, extension(&name).and_then(Format::from_extension)) {
        (Some(to), Some(named)) if to != named => Err(Fault::usage(format!(
            "{name}: the name is that of {named}, but --to says {to}: give a name that ends in .{to}"
        ))),
        (Some(to), None) => match extension(&name).and_then(ForeignFormat::from_extension) {
            Some(foreign) => Err(Fault::usage(format!(
                "{name}: the name is that of {}, but --to says {to}: give a name that ends in .{to}",
                foreign.name
            ))),
            None => Ok(()),
        },
        _ => Ok(()),
    }
}

/// The error for a file extension of a format that is not supported.
fn refuse_foreign(name: &str, known: &str) -> Option<Fault> {
    let foreign = extension(name).and_then(ForeignFormat::from_extension)?;
    let pictures = if foreign.is_picture() { "; `chordal render` takes pictures" } else { "" };
    Some(Fault::usage(format!(
        "{name}: {} cannot be written; formats that can be written are {known}{pictures}",
        foreign.name
    )))
}
