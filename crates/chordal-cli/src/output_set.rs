//! Options for outputs of several files, checked before the work.
use crate::fault::Fault;
use crate::output::OutputTarget;
use crate::overwrite::refuse_occupied;
use chordal_io::Format;
use chordal_io::glb::GltfPacking;
use chordal_verbs::OutputForm;
use chordal_verbs::formats::extensions_where;
use clap::{Args, ValueEnum};

/// Arguments of verbs whose output may be several files.
#[derive(Args, Debug)]
#[command(next_help_heading = "Output")]
pub struct OutputSetArgs {
    /// For .gltf: write the buffer (.bin) and the images as separate files instead of embedding them
    #[arg(long)]
    pub separate: bool,
    /// For .glb and .gltf: compress vertices and triangles losslessly, by an extension that readers must
    /// support
    #[arg(long, value_name = "CODEC")]
    pub compress: Option<Compression>,
    /// For .glb and .gltf: quantize positions to 16 bits, normals to 8 and texture coordinates to 16, by an
    /// extension that readers must support. The bound includes the rounding
    #[arg(long)]
    pub quantize: bool,
}

/// The compression of a glTF.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Compression {
    /// `EXT_meshopt_compression`
    Meshopt,
}

impl OutputSetArgs {
    /// The packing of a glTF.
    pub fn packing(&self) -> GltfPacking {
        GltfPacking {
            is_compressed: self.compress == Some(Compression::Meshopt),
            is_quantized: self.quantize,
        }
    }

    /// A format with this packing.
    pub fn form(&self, format: Format) -> OutputForm {
        OutputForm { format, packing: self.packing() }
    }

    /// Checks the options against the target, as far as possible before the work.
    ///
    /// # Errors
    /// If an option does not fit the format, the target cannot be several files, or the buffer's file may not
    /// be written.
    pub fn check(&self, target: &OutputTarget, format: Format) -> Result<(), Fault> {
        let packing_options = [(self.compress.is_some(), "--compress"), (self.quantize, "--quantize")];
        let given = packing_options.iter().find(|(is_given, _)| *is_given);
        if let Some((_, option)) = given
            && !format.is_gltf()
        {
            let names = extensions_where(Format::is_gltf, "and");
            return Err(Fault::usage(format!("{option} is for {names}; {format} holds plain numbers")));
        }
        if !self.separate {
            return Ok(());
        }
        if !format.has_side_files() {
            return Err(Fault::usage(format!(
                "--separate is for .gltf, which names files beside it; {format} is one file"
            )));
        }
        match target {
            OutputTarget::Stdout => {
                Err(Fault::usage("--separate writes several files, which stdout cannot hold"))
            }
            OutputTarget::File { path, existing } => {
                let buffer = path.with_extension("bin");
                if buffer == *path {
                    let name = path.display();
                    return Err(Fault::usage(format!(
                        "{name}: this would be the name of the buffer beside it"
                    )));
                }
                refuse_occupied(&buffer, *existing)
            }
        }
    }
}
