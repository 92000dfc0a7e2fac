//! The format of an output, by what is said or by its name.
use crate::fault::Fault;
use chordal_io::{ForeignFormat, Format};
use chordal_verbs::extension;
use chordal_verbs::formats::{self, in_words, names_where};
use std::path::Path;

/// The format to write: `--to`, else what the name says.
pub fn output_format(path: &Path, to: Option<Format>) -> Result<Format, Fault> {
    let name = path.display().to_string();
    let by_name = || extension(&name).and_then(Format::from_extension);
    refuse_other_name(path, to)?;
    let known = formats::output_names;
    let format = to.or_else(by_name).ok_or_else(|| {
        refuse_foreign(&name, &known()).unwrap_or_else(|| {
            Fault::usage(format!("{name}: the name does not say the format; --to does, with {}", known()))
        })
    })?;
    if format.holds_triangles() || format.holds_polylines() {
        return Ok(format);
    }
    let why = if format.holds_volumes() { "holds samples alone" } else { "is only read" };
    Err(Fault::usage(format!("{format} {why}; what can be written is {}", known())))
}

/// Any format that is written: `--to`, else what the name says.
pub fn writable_format(path: &Path, to: Option<Format>) -> Result<Format, Fault> {
    let name = path.display().to_string();
    let known = formats::writable_names;
    refuse_other_name(path, to)?;
    let format = to.or_else(|| extension(&name).and_then(Format::from_extension)).ok_or_else(|| {
        refuse_foreign(&name, &known()).unwrap_or_else(|| {
            Fault::usage(format!("{name}: the name does not say the format; --to does, with {}", known()))
        })
    })?;
    if format.holds_triangles() || format.holds_polylines() || format.holds_volumes() {
        return Ok(format);
    }
    Err(Fault::usage(format!("{format} is only read; what can be written is {}", known())))
}

/// The format of a lattice, by what is said or by the name.
pub fn volume_format(path: &Path, to: Option<Format>) -> Result<Format, Fault> {
    let name = path.display().to_string();
    refuse_other_name(path, to)?;
    let format = to.or_else(|| extension(&name).and_then(Format::from_extension));
    let held = || names_where(Format::holds_volumes);
    match format {
        Some(format) if format.holds_volumes() => Ok(format),
        Some(other) => {
            Err(Fault::usage(format!("{other} holds no lattice; {} do", in_words(&held(), "and"))))
        }
        None => Err(refuse_foreign(&name, &held().join(", ")).unwrap_or_else(|| {
            let names = in_words(&held(), "or");
            Fault::usage(format!("{name}: the name does not say the format; --to does, with {names}"))
        })),
    }
}

/// Refuses a name that says another format than what will be in the file.
fn refuse_other_name(path: &Path, to: Option<Format>) -> Result<(), Fault> {
    let name = path.display().to_string();
    match (to, extension(&name).and_then(Format::from_extension)) {
        (Some(to), Some(said)) if to != said => Err(Fault::usage(format!(
            "{name}: the name says {said}, and --to says {to}: give a name that ends in .{to}"
        ))),
        (Some(to), None) => match extension(&name).and_then(ForeignFormat::from_extension) {
            Some(foreign) => Err(Fault::usage(format!(
                "{name}: the name says {}, and --to says {to}: give a name that ends in .{to}",
                foreign.name
            ))),
            None => Ok(()),
        },
        _ => Ok(()),
    }
}

/// The fault of a name that says a format of others.
fn refuse_foreign(name: &str, known: &str) -> Option<Fault> {
    let foreign = extension(name).and_then(ForeignFormat::from_extension)?;
    let pictures = if foreign.is_picture() { "; `chordal render` takes pictures" } else { "" };
    Some(Fault::usage(format!(
        "{name}: the name says {}, which is not written; what can be written is {known}{pictures}",
        foreign.name
    )))
}
