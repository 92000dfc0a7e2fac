//! `TransferSyntax`: how a file encodes its elements, and packs its pixels.
//!
//! Source: NEMA, *DICOM PS3.6*, 2024, annex A.
use super::elements::DicomSyntax;
use crate::volume::element::Endian;

/// The encoding of a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct TransferSyntax {
    pub elements: DicomSyntax,
    /// Whether the data set is deflated as a whole.
    pub is_deflated: bool,
    pub packing: PixelPacking,
}

/// How pixels are packed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum PixelPacking {
    /// Not packed.
    Plain,
    RunLengths,
    /// Baseline, extended or lossless.
    Jpeg,
    /// Lossless or nearly so.
    JpegLs,
    Jpeg2000,
    /// A packing that is not read, by its name.
    Unread(&'static str),
}

impl TransferSyntax {
    /// The transfer syntax with an identifier, if it is one of the standard's.
    pub(super) fn from_uid(uid: &str) -> Option<Self> {
        use PixelPacking::{Jpeg, Jpeg2000, JpegLs, Plain, RunLengths, Unread};
        let little = |is_explicit| Self {
            elements: DicomSyntax { endian: Endian::Little, is_explicit },
            is_deflated: false,
            packing: Plain,
        };
        let explicit = little(true);
        let packing = match uid.strip_prefix("1.2.840.10008.1.2")? {
            "" => return Some(little(false)),
            ".1" => Plain,
            ".1.99" => return Some(Self { is_deflated: true, ..explicit }),
            ".2" => {
                let elements = DicomSyntax { endian: Endian::Big, is_explicit: true };
                return Some(Self { elements, ..explicit });
            }
            ".5" => RunLengths,
            ".4.50" | ".4.51" | ".4.57" | ".4.70" => Jpeg,
            ".4.80" | ".4.81" => JpegLs,
            ".4.90" | ".4.91" => Jpeg2000,
            ".1.98" => Unread("plain pixels in pieces"),
            ".4.92" | ".4.93" => Unread("JPEG 2000 with several components"),
            ".4.94" | ".4.95" | ".4.204" | ".4.205" => Unread("a stream of JPIP, which is not in the file"),
            ".4.100" | ".4.100.1" | ".4.101" | ".4.101.1" => Unread("MPEG-2 video"),
            ".4.102" | ".4.102.1" | ".4.103" | ".4.103.1" | ".4.104" | ".4.104.1" | ".4.105" | ".4.105.1"
            | ".4.106" | ".4.106.1" => Unread("MPEG-4 video"),
            ".4.107" | ".4.108" => Unread("HEVC video"),
            ".4.110" | ".4.111" | ".4.112" => Unread("JPEG XL"),
            ".4.201" | ".4.202" | ".4.203" => Unread("high-throughput JPEG 2000"),
            ".8.1" => Unread("deflated frames"),
            old if old.starts_with(".4.5") || old.starts_with(".4.6") => Unread("JPEG of a retired kind"),
            _ => return None,
        };
        Some(Self { packing, ..explicit })
    }
}
