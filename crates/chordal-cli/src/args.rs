//! Arguments that several verbs share: input, output and report, with the parsers of their values.
use crate::memory;
use crate::options::TableArgs;
use crate::overwrite::OverwritePolicy;
use chordal_verbs::options::ReadOptions;
use clap::Args;
use std::path::PathBuf;

/// Arguments that every verb with an input takes.
#[derive(Args, Clone, Debug)]
#[command(next_help_heading = "Input")]
pub struct InputArgs {
    /// Input file; '-' reads stdin
    #[arg(value_name = "IN", index = 1, help_heading = None::<&str>)]
    pub input: PathBuf,

    /// Level of detail to read from a glTF; 0 is the finest. Only `verify` reads others.
    #[arg(skip)]
    pub level: usize,

    #[command(flatten)]
    pub read: TableArgs<ReadOptions>,

    /// Maximum memory, e.g. 512M or 8G. Default: half of the machine's or its control group's. An input file
    /// may be no larger than that, nor than 4 GiB
    #[arg(long, value_name = "BYTES", value_parser = bytes)]
    pub max_memory: Option<u64>,

    /// For a shape script: a folder that it may read meshes from, besides its own; repeatable
    #[arg(long, value_name = "FOLDER")]
    pub allow: Vec<PathBuf>,
}

impl InputArgs {
    /// The most memory: `--max-memory`, else a share of the machine's.
    pub fn memory_limit(&self) -> Option<u64> {
        self.max_memory.or_else(memory::default_limit)
    }
}

/// Arguments for messages and reports.
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

impl OutputArgs {
    /// What happens to an existing output.
    pub fn existing(&self) -> OverwritePolicy {
        OverwritePolicy::from_force(self.force)
    }
}

/// `512M`, `8G`, `1000000`: units are powers of 1024, as usual for memory.
pub(crate) fn bytes(text: &str) -> Result<u64, String> {
    let wrong = || format!("expected a number of bytes like 512M or 8G, not '{text}'");
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
}
