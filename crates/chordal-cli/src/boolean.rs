//! `--union`, `--minus` and `--intersect` of `chordal mesh`, in the order of the command line.
use crate::args::InputArgs;
use crate::console::Console;
use crate::fault::Fault;
use crate::input::InputSource;
use crate::load;
use crate::overwrite::refuse_input;
use chordal::Job;
use chordal::boolean::BooleanOp;
use chordal_verbs::BooleanOperand;
use clap::{Arg, ArgAction, ArgMatches, Args, Command, Error, FromArgMatches, value_parser};
use std::path::{Path, PathBuf};

/// The names of the options, their operations and their help texts.
const OPTIONS: [(&str, BooleanOp, &str); 3] = [
    (
        "union",
        BooleanOp::Union,
        "Unite with another solid; these options are repeatable, and apply from left to right",
    ),
    ("minus", BooleanOp::Difference, "Subtract another solid"),
    ("intersect", BooleanOp::Intersection, "Keep only the part inside another solid"),
];

/// The solids to combine with the input.
#[derive(Clone, Debug, Default)]
pub struct BooleanArgs {
    /// In the order of the command line.
    pub operands: Vec<(BooleanOp, PathBuf)>,
}

impl Args for BooleanArgs {
    fn augment_args(command: Command) -> Command {
        OPTIONS.into_iter().fold(command, |command, (name, _, help)| {
            command.arg(
                Arg::new(name)
                    .long(name)
                    .value_name("FILE")
                    .help(help)
                    .help_heading("Combine")
                    .action(ArgAction::Append)
                    .value_parser(value_parser!(PathBuf))
                    .conflicts_with_all(["level", "triangles", "segments"]),
            )
        })
    }

    fn augment_args_for_update(command: Command) -> Command {
        Self::augment_args(command)
    }
}

impl FromArgMatches for BooleanArgs {
    fn from_arg_matches(matches: &ArgMatches) -> Result<Self, Error> {
        let mut operands: Vec<(usize, BooleanOp, PathBuf)> = Vec::new();
        for (name, op, _) in OPTIONS {
            let (Some(indices), Some(paths)) = (matches.indices_of(name), matches.get_many::<PathBuf>(name))
            else {
                continue;
            };
            operands.extend(indices.zip(paths).map(|(index, path)| (index, op, path.clone())));
        }
        // The parser gives each option's values by themselves: only their indices tell the order across
        // options.
        operands.sort_by_key(|(index, ..)| *index);
        let operands = operands.into_iter().map(|(_, op, path)| (op, path)).collect();
        Ok(Self { operands })
    }

    fn update_from_arg_matches(&mut self, matches: &ArgMatches) -> Result<(), Error> {
        *self = Self::from_arg_matches(matches)?;
        Ok(())
    }
}

impl BooleanArgs {
    /// Refuses an output that is one of the operands' files.
    pub fn refuse_output(&self, output: &Path) -> Result<(), Fault> {
        self.operands.iter().try_for_each(|(_, path)| refuse_input(output, &InputSource::from_arg(path)))
    }

    /// The paths of the operands.
    pub fn paths(&self) -> impl Iterator<Item = &PathBuf> {
        self.operands.iter().map(|(_, path)| path)
    }

    /// The possible paths of the files that the operands reference.
    pub fn files_beside(&self, args: &InputArgs, others: &[BooleanOperand]) -> Vec<PathBuf> {
        let files_of = |(path, other): (&PathBuf, &BooleanOperand)| {
            let operand_args = InputArgs { input: path.clone(), ..args.clone() };
            load::files_beside(&operand_args, &other.input).collect::<Vec<_>>()
        };
        self.paths().zip(others).flat_map(files_of).collect()
    }

    /// Reads the operands.
    pub fn read(&self, args: &InputArgs, job: &Job, console: &Console) -> Result<Vec<BooleanOperand>, Fault> {
        self.operands
            .iter()
            .map(|(op, path)| {
                let mut operand_args = InputArgs { input: path.clone(), ..args.clone() };
                (operand_args.read.from, operand_args.read.unit, operand_args.read.up) = (None, None, None);
                let source = InputSource::from_arg(path);
                if matches!(source, InputSource::Stdin) {
                    return Err(Fault::usage("only the input itself can be stdin"));
                }
                let mut input = load::read_other(&operand_args, job, console)?;
                // --unit and --up describe the input; they apply to an operand only if its file has no unit
                // or up axis.
                let frame = input.shape.frame_mut();
                frame.metres_per_unit = frame.metres_per_unit.or(args.read.unit.map(|unit| unit.metres()));
                frame.up = frame.up.or(args.read.up);
                Ok(BooleanOperand { op: *op, name: source.name(), input })
            })
            .collect()
    }
}
