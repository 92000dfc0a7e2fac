//! The command line: all verbs, and the exit codes.
use crate::bake::BakeArgs;
#[cfg(not(target_family = "wasm"))]
use crate::batch::BatchArgs;
use crate::convert::ConvertArgs;
use crate::deviation::DeviationArgs;
use crate::inspect::InspectArgs;
use crate::language::LanguageArgs;
use crate::lod::LodArgs;
use crate::mend::MendArgs;
use crate::mesh::MeshArgs;
use crate::render::RenderArgs;
#[cfg(not(target_family = "wasm"))]
use crate::studio::StudioArgs;
use crate::verify::VerifyArgs;
use clap::{Parser, Subcommand};
use clap_complete::Shell;
use std::path::PathBuf;

/// You bring a budget, you leave with a bound.
///
/// Turns shapes into triangles within an error budget, in units or in pixels, and reports how large the error
/// is and how that is known: proved, measured or estimated.
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
    1  a check failed, or some files of a batch failed
    2  the command line is invalid
    3  the input cannot be read or is not supported
    4  the output cannot be written
    5  the budget was not reached, or cannot be
    6  a claim of a certificate was neither re-proved nor refuted
  130  interrupted

Messages go to stderr, data to stdout. '-' is stdin or stdout. Colours obey NO_COLOR.";

/// The verbs.
#[derive(Debug, Subcommand)]
pub enum Verb {
    /// Turn any shape into triangles, or curves into polylines, within a budget
    Mesh(MeshArgs),
    /// Make levels of detail, each with a proved error: one .glb, or a folder of 3D Tiles
    Lod(LodArgs),
    /// Show what a file contains, and list its defects
    Inspect(InspectArgs),
    /// Measure how far two shapes are apart, between proved bounds
    Deviation(DeviationArgs),
    /// Prove the certificate of a file again, independently of the code that made the file
    Verify(VerifyArgs),
    /// Repair what `inspect` found, and list every change
    Mend(MendArgs),
    /// Sample the signed distance of a shape on a grid, negative inside
    Bake(BakeArgs),
    /// Write the same shape in another format, and list what that format cannot hold
    Convert(ConvertArgs),
    /// Render a picture: .png, .jpg or .webp
    Render(RenderArgs),
    /// Run one of these on many files, and resume where it was stopped
    #[cfg(not(target_family = "wasm"))]
    Batch(BatchArgs),
    /// Open the lesson and the workbench in a browser
    #[cfg(not(target_family = "wasm"))]
    Studio(StudioArgs),
    /// Print the functions of shape scripts
    Language(LanguageArgs),
    /// Print a shell's completion script
    Completions {
        /// Which shell
        shell: Shell,
    },
    /// Write the manual pages
    Man {
        /// The folder to write them to; it is created if it does not exist
        #[arg(short, long, value_name = "DIR")]
        output: PathBuf,
    },
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::spelling::CommandLine;
    use chordal::budget::advice::{Cure, Setting, Spelling};
    use clap::CommandFactory;

    #[test]
    fn the_command_line_holds_together() {
        Cli::command().debug_assert();
    }

    #[test]
    fn every_setting_is_an_option_of_some_verb() {
        let command = Cli::command();
        let options: Vec<String> = command
            .get_subcommands()
            .flat_map(|verb| verb.get_arguments())
            .filter_map(|argument| Some(format!("--{}", argument.get_long()?)))
            .collect();
        for setting in Setting::PLAIN.into_iter().chain(Cure::ALL.map(Setting::Cure)) {
            let spelled = CommandLine.spell(setting, None);
            assert!(options.contains(&spelled), "there is no {spelled}");
        }
    }
}
