//! The table of labels in an extension of a NIfTI header, in the XML of Caret and Connectome Workbench, which
//! TotalSegmentator also writes.
use crate::volume::element::Endian;
use crate::volume::label_table::MOST_ROWS;
use crate::xml_elements::{AnyNamespace, XmlElements, XmlStep};
use crate::{LabelLook, Limits, ReadError};
use std::collections::BTreeMap;

/// The most bytes of extensions that are searched. Chosen: a table of 65,536 labels has less than 8 MiB.
pub(super) const MOST_BYTES: u64 = 8 << 20;

/// The labels in the extensions after a header, and the reason if a table cannot be read. `bytes` begin with
/// the four bytes that tell whether there are any.
///
/// Source: R. Cox and others, *NIfTI-1 Data Format*, 2004, "extensions"; D. Van Essen Lab, *CIFTI-2*, 2014, whose
/// `LabelTable` has the same elements.
pub(super) fn label_table(
    bytes: &[u8],
    endian: Endian,
    limits: &Limits,
) -> (BTreeMap<i64, LabelLook>, Option<ReadError>) {
    let mut rest = match bytes {
        [flag, _, _, _, rest @ ..] if *flag != 0 => rest,
        _ => return Default::default(),
    };
    // Each extension has its size, which includes eight bytes of header, and a code.
    while rest.len() > 8 {
        let size = i32::from_le_bytes(endian.array(&rest[..4]));
        let Some(size) = usize::try_from(size).ok().filter(|size| (8..=rest.len()).contains(size)) else {
            break;
        };
        let text = &rest[8..size];
        rest = &rest[size..];
        // The code is 30 for Caret, but TotalSegmentator writes 0, so only the content tells the kind.
        if memchr::memmem::find(text, b"<LabelTable").is_none() {
            continue;
        }
        return match parse(text, limits) {
            Ok(labels) => (labels, None),
            Err(error) => (BTreeMap::new(), Some(error)),
        };
    }
    Default::default()
}

fn parse(text: &[u8], limits: &Limits) -> Result<BTreeMap<i64, LabelLook>, ReadError> {
    // An extension is padded with zeros to a multiple of 16 bytes.
    let end = text.iter().rposition(|b| *b != 0).map_or(0, |last| last + 1);
    let text = crate::xml_text::text_of(&text[..end])?;
    let mut elements = XmlElements::<AnyNamespace>::new(text.trim(), "the table of labels", limits);
    let mut labels = BTreeMap::new();
    let mut open: Option<(i64, LabelLook)> = None;
    while let Some(step) = elements.next()? {
        match step {
            XmlStep::Start(element) if element.local == "Label" => {
                let key = elements.need("Key")?.trim().parse();
                let key = key.map_err(|_| elements.error("bad-label", "a label's Key is no whole number"))?;
                let channel = |name: &str| -> Option<f64> {
                    let value = elements.get(name)?.trim().parse::<f64>().ok()?;
                    (0.0..=1.0).contains(&value).then_some(value)
                };
                let color = || Some([channel("Red")?, channel("Green")?, channel("Blue")?]);
                open = Some((key, LabelLook { name: String::new(), color: color() }));
            }
            XmlStep::Text(text) => {
                if let Some((_, look)) = &mut open {
                    look.name += &text;
                }
            }
            XmlStep::End => {
                if let Some((key, mut look)) = open.take() {
                    look.name = crate::volume::name_of(look.name.as_bytes());
                    labels.insert(key, look);
                }
            }
            XmlStep::Start(_) => {}
        }
        if labels.len() > MOST_ROWS {
            return Err(elements.error("too-many-labels", format_args!("more than {MOST_ROWS} labels")));
        }
    }
    Ok(labels)
}
