//! `TableArgs`: a table of options as arguments of the command.
use chordal_verbs::options::{OptionRow, OptionTable, OptionValues, spelled_help};
use clap::builder::{PossibleValue, PossibleValuesParser};
use clap::parser::ValueSource;
use clap::{Arg, ArgAction, ArgGroup, ArgMatches, Args, Command, Error, FromArgMatches};
use std::ops::{Deref, DerefMut};

/// The options of a table as they were given.
#[derive(Clone, Debug)]
pub struct TableArgs<S> {
    /// The request that they make; large, beside other arguments.
    request: Box<S>,
    /// The first option that was given.
    pub first_given: Option<&'static str>,
}

impl<S> Deref for TableArgs<S> {
    type Target = S;

    fn deref(&self) -> &S {
        &self.request
    }
}

impl<S> DerefMut for TableArgs<S> {
    fn deref_mut(&mut self) -> &mut S {
        &mut self.request
    }
}

impl<S: OptionTable> Args for TableArgs<S> {
    fn augment_args(command: Command) -> Command {
        let mut groups: Vec<&str> = S::ROWS.iter().flat_map(|row| row.groups).copied().collect();
        groups.sort_unstable();
        groups.dedup();
        let command = S::ROWS.iter().fold(command, |command, row| command.arg(argument(row)));
        groups.into_iter().fold(command, |command, group| {
            let members = S::ROWS.iter().filter(|row| row.groups.contains(&group)).map(|row| row.name);
            let is_required = S::REQUIRED_GROUP == Some(group);
            command.group(ArgGroup::new(group).args(members).multiple(true).required(is_required))
        })
    }

    fn augment_args_for_update(command: Command) -> Command {
        Self::augment_args(command)
    }
}

impl<S: OptionTable> FromArgMatches for TableArgs<S> {
    fn from_arg_matches(matches: &ArgMatches) -> Result<Self, Error> {
        let mut args = Self { request: Box::default(), first_given: None };
        for row in S::ROWS {
            let is_given = matches.value_source(row.name) == Some(ValueSource::CommandLine);
            if is_given {
                args.first_given = args.first_given.or(Some(row.name));
            }
            let texts: Vec<&str> = if row.values == OptionValues::Flag {
                Vec::from_iter(is_given.then_some(""))
            } else {
                matches.get_many::<String>(row.name).into_iter().flatten().map(String::as_str).collect()
            };
            for text in texts {
                // The parser of the argument has accepted the text alone.
                (row.set)(&mut args.request, text)
                    .map_err(|why| Error::raw(clap::error::ErrorKind::ValueValidation, why))?;
            }
        }
        Ok(args)
    }

    fn update_from_arg_matches(&mut self, matches: &ArgMatches) -> Result<(), Error> {
        *self = Self::from_arg_matches(matches)?;
        Ok(())
    }
}

/// How options of a table are written on the command line.
fn spelled(name: &str, value: Option<&str>) -> String {
    value.map_or_else(|| format!("--{name}"), |value| format!("--{name} {value}"))
}

/// An option as an argument.
fn argument<S: OptionTable>(row: &'static OptionRow<S>) -> Arg {
    let argument = Arg::new(row.name)
        .long(row.name)
        .help(spelled_help(row.help, spelled))
        .help_heading(row.section.heading())
        .conflicts_with_all(row.conflicts.iter().copied());
    let argument = row.needs.into_iter().fold(argument, |argument, needed| argument.requires(needed));
    let argument =
        row.default.into_iter().fold(argument, |argument, default| argument.default_value(default));
    let action = match (row.values, row.is_repeatable) {
        (OptionValues::Flag, _) => return argument.action(ArgAction::SetTrue),
        (_, true) => ArgAction::Append,
        (_, false) => ArgAction::Set,
    };
    let argument = argument.value_name(row.value_name).action(action);
    let argument = match row.bare {
        Some(bare) => argument.num_args(0..=1).require_equals(true).default_missing_value(bare),
        None => argument,
    };
    if let OptionValues::Words(words) = row.values {
        let words =
            words.iter().map(|(word, help)| PossibleValue::new(*word).help(spelled_help(help, spelled)));
        return argument.value_parser(PossibleValuesParser::new(words));
    }
    // Longitudes and latitudes can begin with a minus as well.
    argument
        .allow_hyphen_values(row.values != OptionValues::Time)
        .value_parser(move |text: &str| (row.set)(&mut S::default(), text).map(|()| text.to_owned()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use chordal_verbs::SurfaceSpec;
    use chordal_verbs::options::MeshOptions;
    use clap::error::ErrorKind;

    fn parse<S: OptionTable>(line: &str) -> Result<TableArgs<S>, Error> {
        let command = TableArgs::<S>::augment_args(Command::new("test"));
        let matches = command.try_get_matches_from(std::iter::once("test").chain(line.split(' ')))?;
        TableArgs::from_arg_matches(&matches)
    }

    #[test]
    fn the_order_of_options_does_not_matter() {
        let first = parse::<MeshOptions>("--tol 0.1 --angle 5deg --normals flat").expect("all are options");
        let second = parse::<MeshOptions>("--normals flat --angle 5 --tol 0.1").expect("all are options");
        assert_eq!(first.request.spec().ok(), second.request.spec().ok());
        assert_eq!(first.first_given, Some("tol"));
    }

    #[test]
    fn defaults_are_not_given() {
        let args = parse::<MeshOptions>("--keep-best").expect("a flag");
        assert_eq!(args.first_given, Some("keep-best"));
        assert!(args.request.keep_best);
    }

    #[test]
    fn rows_say_what_belongs_together() {
        let kind = |line: &str| parse::<MeshOptions>(line).map(|_| ()).map_err(|error| error.kind());
        assert_eq!(kind("--angle 5"), Err(ErrorKind::MissingRequiredArgument));
        assert_eq!(kind("--bevel 1"), Err(ErrorKind::MissingRequiredArgument));
        assert_eq!(kind("--level 2 --tol 1"), Err(ErrorKind::ArgumentConflict));
        assert_eq!(kind("--tol -1"), Err(ErrorKind::ValueValidation));
        assert_eq!(kind("--effort slow"), Err(ErrorKind::InvalidValue));
        assert_eq!(kind("--tol 1 --triangles 5"), Ok(()));
        let kind = |line: &str| parse::<SurfaceSpec>(line).map(|_| ()).map_err(|error| error.kind());
        assert_eq!(kind("--iso -1"), Ok(()));
        assert_eq!(kind("--iso 1 --labels all"), Err(ErrorKind::ArgumentConflict));
    }
}
