//! `OptionRow`: what a user can set. Each option stands in one table, with its name, its values, its help, and how it
//! changes a request.
//!
//! Every front end reads these tables: the command makes arguments of them, the Python package keywords, the web module
//! keys of JSON, and `docs/options.md` is written from them. A value is always a text as the command reads it, so that
//! one parser judges it, whichever front end it comes from.
mod bake;
mod convert;
mod deviation;
mod effort;
mod inspect;
mod lod;
mod mend;
mod mesh;
mod output;
mod picture;
mod reading;
mod surface;
pub mod values;
mod verify;

pub use bake::BakeOptions;
pub use convert::ConvertOptions;
pub use inspect::InspectOptions;
pub use lod::{LodContainer, LodOptions};
pub use mend::MendOptions;
pub use mesh::MeshOptions;
pub use output::OutputOptions;
pub use picture::{PictureContent, PictureOptions};
pub use reading::ReadOptions;
pub use surface::not_a_volume;
pub use verify::VerifyOptions;

/// A set of options: the row of each, and the request that they change.
///
/// ```
/// use chordal_verbs::options::{MeshOptions, OptionTable};
/// let mut options = MeshOptions::default();
/// options.set("tol", "0.05%")?;
/// options.set("angle", "5deg")?;
/// assert!(options.spec().is_ok_and(|spec| spec.has_limit()));
/// assert!(options.set("tol", "thick").is_err());
/// # Ok::<(), String>(())
/// ```
pub trait OptionTable: Default + Send + Sync + 'static {
    /// The group of which one option has to be given, if there is one.
    const REQUIRED_GROUP: Option<&'static str> = None;

    /// Options that rows refer to and that each front end has itself, since they name other shapes.
    const BESIDE: &'static [&'static str] = &[];

    /// The options, in the order in which help lists them.
    const ROWS: &'static [OptionRow<Self>];

    /// The row with this name.
    #[must_use]
    fn row(name: &str) -> Option<&'static OptionRow<Self>> {
        Self::ROWS.iter().find(|row| row.name == name)
    }

    /// Sets one option from the text of its value, which is empty for a flag.
    ///
    /// # Errors
    /// A sentence without the option's name, if the table has no such option or the text is no value of it.
    fn set(&mut self, name: &str, text: &str) -> Result<(), String> {
        let row = Self::row(name).ok_or_else(|| format!("there is no option '{name}'"))?;
        (row.set)(self, text)
    }
}

/// One option of a table that changes a request of type `S`.
pub struct OptionRow<S> {
    /// The name, with hyphens.
    pub name: &'static str,
    /// The keyword of the Python package, if it is not the name with `_` for `-`: see [`Self::keyword`].
    renamed: Option<&'static str>,
    /// Whether a method of the Python package takes it.
    is_keyword: bool,
    /// The values that it takes.
    pub values: OptionValues,
    /// What help calls the value: `LENGTH`.
    pub value_name: &'static str,
    /// The heading that help lists it under.
    pub section: OptionSection,
    /// What it does: one or two sentences, without the stop of the last. Other options stand in braces, as in `{view}`
    /// and `{require=proved}`: see [`spelled_help`].
    pub help: &'static str,
    /// The value that counts if none is given.
    pub default: Option<&'static str>,
    /// The options or the group of which one has to be given with it.
    pub needs: Option<&'static str>,
    /// The options and groups that exclude it.
    pub conflicts: &'static [&'static str],
    /// The groups that it belongs to.
    pub groups: &'static [&'static str],
    /// The value if it is given without one; options with such a value take another only after `=`.
    pub bare: Option<&'static str>,
    /// Whether it may be given several times.
    pub is_repeatable: bool,
    /// Sets it from the text of a value.
    pub set: fn(&mut S, &str) -> Result<(), String>,
}

/// The values of an option.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum OptionValues {
    /// None: it is given or it is not.
    Flag,
    /// A whole number greater than 0, or from 0 on.
    Count,
    /// A number, which may have a unit of its own, such as `5deg`.
    Number,
    /// A length: in units of the shape, in a unit such as `0.1mm`, or as `0.05%` of the diagonal of its bounding box.
    Length,
    /// A time: `20s`, `2m` or `500ms`.
    Time,
    /// One of these words, each with its help.
    Words(&'static [(&'static str, &'static str)]),
    /// A text.
    Text,
}

/// The heading that help lists an option under.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum OptionSection {
    /// What the verb does; its options come first, under no heading of their own.
    Verb,
    /// How the result is written.
    Output,
    /// How the input is read.
    Input,
    /// How much error is allowed.
    Budget,
    /// What the result is.
    Result,
    /// Levels of detail.
    Levels,
    /// Repairs of meshes.
    Repairs,
    /// Which surface of a volume is meshed.
    Volumes,
}

impl OptionSection {
    /// The heading, if it has one.
    #[must_use]
    pub fn heading(self) -> Option<&'static str> {
        match self {
            Self::Verb => None,
            Self::Output => Some("Output"),
            Self::Input => Some("Input"),
            Self::Budget => Some("Budget"),
            Self::Result => Some("Result"),
            Self::Levels => Some("Levels"),
            Self::Repairs => Some("Repairs"),
            Self::Volumes => Some("Volumes"),
        }
    }
}

/// Rows are written in tables: a name, its values and their name, help, and a setter; what else there is follows.
impl<S> OptionRow<S> {
    const fn new(
        name: &'static str,
        (values, value_name): (OptionValues, &'static str),
        help: &'static str,
        set: fn(&mut S, &str) -> Result<(), String>,
    ) -> Self {
        Self {
            name,
            renamed: None,
            is_keyword: true,
            values,
            value_name,
            section: OptionSection::Budget,
            help,
            default: None,
            needs: None,
            conflicts: &[],
            groups: &[],
            bare: None,
            is_repeatable: false,
            set,
        }
    }

    const fn flag(
        name: &'static str,
        help: &'static str,
        set: fn(&mut S, &str) -> Result<(), String>,
    ) -> Self {
        Self::new(name, (OptionValues::Flag, ""), help, set)
    }

    const fn under(self, section: OptionSection) -> Self {
        Self { section, ..self }
    }

    const fn renamed(self, keyword: &'static str) -> Self {
        Self { renamed: Some(keyword), ..self }
    }

    const fn without_keyword(self) -> Self {
        Self { is_keyword: false, ..self }
    }

    /// The format of the output, which Python's methods for writing take.
    const fn output_format(set: fn(&mut S, &str) -> Result<(), String>) -> Self {
        let help = "Output format, if not the one that the file name implies";
        Self::new("to", (OptionValues::Text, "FORMAT"), help, set)
            .without_keyword()
            .under(OptionSection::Result)
    }

    const fn default(self, default: &'static str) -> Self {
        Self { default: Some(default), ..self }
    }

    const fn needs(self, needs: &'static str) -> Self {
        Self { needs: Some(needs), ..self }
    }

    const fn conflicts(self, conflicts: &'static [&'static str]) -> Self {
        Self { conflicts, ..self }
    }

    const fn in_groups(self, groups: &'static [&'static str]) -> Self {
        Self { groups, ..self }
    }

    const fn or_bare(self, bare: &'static str) -> Self {
        Self { bare: Some(bare), ..self }
    }

    const fn repeatable(self) -> Self {
        Self { is_repeatable: true, ..self }
    }
}

impl<S> OptionRow<S> {
    /// The keyword of the Python package, if a method takes it.
    #[must_use]
    pub fn keyword(&self) -> Option<String> {
        self.is_keyword.then(|| self.renamed.map_or_else(|| self.name.replace('-', "_"), str::to_owned))
    }
}

/// The help of an option or of one of its words, with other options as a front end spells them: each by its name, and its
/// value if it has one.
#[must_use]
pub fn spelled_help(help: &str, spell: impl Fn(&str, Option<&str>) -> String) -> String {
    let mut parts = help.split('{');
    let mut spelled = parts.next().unwrap_or_default().to_owned();
    for part in parts {
        let (option, words) = part.split_once('}').unwrap_or((part, ""));
        spelled.push_str(&match option.split_once('=') {
            Some((name, value)) => spell(name, Some(value)),
            None => spell(option, None),
        });
        spelled.push_str(words);
    }
    spelled
}

const LENGTH: (OptionValues, &str) = (OptionValues::Length, "LENGTH");
const COUNT: (OptionValues, &str) = (OptionValues::Count, "N");
const ANGLE: (OptionValues, &str) = (OptionValues::Number, "ANGLE");

/// Stores a value that was read.
fn store<T, E: std::fmt::Display>(place: &mut T, value: Result<T, E>) -> Result<(), String> {
    *place = value.map_err(|error| error.to_string())?;
    Ok(())
}

/// The same for what may be left out.
fn store_some<T, E: std::fmt::Display>(place: &mut Option<T>, value: Result<T, E>) -> Result<(), String> {
    *place = Some(value.map_err(|error| error.to_string())?);
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{DeviationSpec, SurfaceSpec};

    #[test]
    fn help_names_options_of_the_same_table() {
        fn check<S: OptionTable>() {
            let is_option = |name: &str| S::row(name).is_some() || S::BESIDE.contains(&name);
            for row in S::ROWS {
                let words = match row.values {
                    OptionValues::Words(words) => words,
                    _ => &[],
                };
                for help in words.iter().map(|(_, help)| *help).chain([row.help]) {
                    let _ = spelled_help(help, |name, _| {
                        assert!(is_option(name), "{}: there is no {name}", row.name);
                        String::new()
                    });
                }
                let of_table = |name: &&'static str| {
                    is_option(name) || S::ROWS.iter().any(|row| row.groups.contains(name))
                };
                assert!(row.needs.iter().chain(row.conflicts).all(of_table), "{}", row.name);
            }
        }
        check::<MeshOptions>();
        check::<LodOptions>();
        check::<MendOptions>();
        check::<SurfaceSpec>();
        check::<ReadOptions>();
        check::<OutputOptions>();
        check::<BakeOptions>();
        check::<ConvertOptions>();
        check::<DeviationSpec>();
        check::<InspectOptions>();
        check::<PictureOptions>();
        check::<VerifyOptions>();
    }

    #[test]
    fn a_shell_spells_the_options_in_help() {
        let row = MeshOptions::row("within").expect("it is in the table");
        let help = spelled_help(row.help, |name, value| format!("<{name} {}>", value.unwrap_or("-")));
        assert!(help.contains("<require proved> or <effort best>"), "{help}");
    }
}
