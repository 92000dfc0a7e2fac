//! `chordal render`
use crate::args::RenderArgs;
use crate::fault::Fault;
pub fn run(_args: &RenderArgs) -> Result<(), Fault> {
    Err(Fault::usage("later"))
}
