//! `OutputOptions`: how results are written, for every verb that writes shapes.
use super::values::word;
use super::{OptionRow, OptionSection, OptionTable, OptionValues, store};
use crate::OutputForm;
use crate::formats::extensions_where;
use crate::report::Certificate;
use chordal::budget::advice::{Message, Setting};
use chordal_io::Format;
use chordal_io::glb::GltfPacking;

/// How the files of a result are written.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct OutputOptions {
    /// Whether the buffer and the images of a glTF are files of their own.
    pub is_separate: bool,
    /// How a glTF stores its numbers.
    pub packing: GltfPacking,
    /// Whether the scripts that a file was made from are left out of it.
    pub leaves_out_sources: bool,
}

impl OutputOptions {
    /// Removes from the certificate of a result what its file is not to carry.
    pub fn strip(&self, certificate: &mut Certificate) {
        if self.leaves_out_sources {
            certificate.leave_out_sources();
        }
    }

    /// A file of a format, written so.
    ///
    /// # Errors
    /// If the format has only one way to store numbers, and another one was asked for.
    pub fn form(&self, format: Format) -> Result<OutputForm, Message> {
        let packing = self.packing;
        let options = [(packing.is_compressed, Setting::Compress), (packing.is_quantized, Setting::Quantize)];
        match options.into_iter().find(|(is_given, _)| *is_given) {
            Some((_, setting)) if !format.is_gltf() => {
                let names = extensions_where(Format::is_gltf, "and");
                let message = Message::from("").setting(setting);
                Err(message.words(format_args!(" is for {names}; {format} holds plain numbers")))
            }
            _ => Ok(OutputForm { format, packing }),
        }
    }
}

const CODECS: OptionValues = OptionValues::Words(&[("meshopt", "`EXT_meshopt_compression`")]);

impl OptionTable for OutputOptions {
    const ROWS: &'static [OptionRow<Self>] = &[
        OptionRow::<Self>::flag(
            "separate",
            "For .gltf: write the buffer (.bin) and the images as separate files instead of embedding them",
            |options, _| {
                options.is_separate = true;
                Ok(())
            },
        )
        .under(OptionSection::Output)
        .without_keyword(),
        OptionRow::<Self>::new(
            "compress",
            (CODECS, "CODEC"),
            "For .glb and .gltf: compress vertices and triangles losslessly, by an extension that readers must support",
            |options, text| store(&mut options.packing.is_compressed, word(text, &[("meshopt", true)])),
        )
        .under(OptionSection::Output),
        OptionRow::<Self>::flag(
            "quantize",
            "For .glb and .gltf: quantize positions to 16 bits, normals to 8 and texture coordinates to 16, by an extension \
             that readers must support. The bound includes the rounding",
            |options, _| {
                options.packing.is_quantized = true;
                Ok(())
            },
        )
        .under(OptionSection::Output),
        OptionRow::<Self>::flag(
            "no-source",
            "For .glb, .gltf and .3mf: leave out the text and the parameters of the shape script, which the file otherwise \
             carries",
            |options, _| {
                options.leaves_out_sources = true;
                Ok(())
            },
        )
        .under(OptionSection::Output),
    ];
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_gltf_is_packed() {
        let mut options = OutputOptions::default();
        assert_eq!(options.form(Format::Stl).ok(), Some(Format::Stl.into()));
        options.set("compress", "meshopt").expect("a codec");
        assert!(options.form(Format::Glb).is_ok_and(|form| form.packing.is_compressed));
        let why = options.form(Format::Stl).expect_err("stl is not compressed").to_string();
        assert!(why.ends_with(" is for .glb and .gltf; stl holds plain numbers"), "{why}");
        assert_eq!(options.set("compress", "draco"), Err("'meshopt', not 'draco'".to_owned()));
    }
}
