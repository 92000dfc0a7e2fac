//! Detects whether a `.obj` is Wavefront text or another format with the same extension.
use crate::text::{LineTokens, TextLines, is_space, number, text_of};
use crate::{FileLocation, ReadError};

/// Statements of Wavefront OBJ that are not supported, grouped by the warning that they cause.
pub(super) const SKIPPED: [(&str, &[&str]); 3] = [
    ("free-form geometry was skipped", &FREE_FORM),
    ("display and rendering attributes were skipped", &DISPLAY),
    ("scripts and includes were skipped; nothing in a model ever runs", &["call", "csh", "csh-", "scmp"]),
];

const FREE_FORM: [&str; 23] = [
    "vp", "cstype", "deg", "bmat", "step", "curv", "curv2", "surf", "parm", "trim", "hole", "scrv", "sp",
    "end", "con", "mg", "bsp", "bzp", "cdc", "cdp", "res", "rat", "cvt",
];

const DISPLAY: [&str; 9] =
    ["maplib", "usemap", "bevel", "c_interp", "d_interp", "lod", "shadow_obj", "trace_obj", "ctech"];

/// The supported statements.
const READ: [&str; 13] = ["v", "vt", "vn", "f", "fo", "g", "o", "s", "usemtl", "mtllib", "l", "p", "t"];

/// Whether the first statement is one of Wavefront OBJ.
pub(crate) fn looks_like(bytes: &[u8]) -> bool {
    // Chosen: enough for the longest leading comments that were seen; files with longer ones need the
    // extension.
    const HEAD: usize = 64 << 10;
    let head = &bytes[..bytes.len().min(HEAD)];
    let Ok(text) = text_of(head) else { return false };
    let words = |line| LineTokens::new(line);
    let statement = TextLines::new(text).map(|(_, line)| line).find(|line| {
        let first = words(line).next();
        first.is_some_and(|word| !word.starts_with(b"#"))
    });
    let Some(line) = statement else { return false };
    let Some(Ok(word)) = words(line).next().map(std::str::from_utf8) else { return false };
    match word {
        "v" | "vt" | "vn" | "vp" => words(line).nth(1).is_some_and(|w| number(w).is_some()),
        _ => READ.contains(&word) || SKIPPED.iter().any(|(_, list)| list.contains(&word)),
    }
}

/// Refuses compiled object code and the polygon files of medical imaging, which also have the extension
/// `.obj`.
///
/// # Errors
/// `not-wavefront`.
pub(super) fn refuse_foreign(bytes: &[u8]) -> Result<(), ReadError> {
    let refuse = |what: &str| {
        let message = format!("not Wavefront OBJ: this is {what}");
        Err(ReadError::new("not-wavefront", FileLocation::Byte(0), message))
    };
    if let Some(what) = object_code(bytes) {
        return refuse(what);
    }
    // An MNI polygon file starts with `P`, five surface properties and the number of points; a binary one
    // with `p`.
    let start = bytes.iter().position(|b| !is_space(*b)).unwrap_or(0);
    let first = TextLines::new(&bytes[start..]).next().map_or(&[][..], |(_, line)| line);
    let mut words = LineTokens::new(first);
    let is_p = words.next() == Some(b"P");
    if is_p && words.clone().count() >= 6 && words.take(6).all(|w| number(w).is_some()) {
        return refuse("an MNI polygon object");
    }
    if bytes.first() == Some(&b'p') && bytes.iter().take(64).any(|b| *b == 0) {
        return refuse("a binary MNI polygon object");
    }
    Ok(())
}

/// The kind of object code that the first bytes indicate, if any.
fn object_code(bytes: &[u8]) -> Option<&'static str> {
    // Machine types of COFF: i386, AMD64, ARM, Thumb, ARM64, and the mark of anonymous and big objects.
    const COFF: [[u8; 2]; 6] =
        [[0x4c, 0x01], [0x64, 0x86], [0xc0, 0x01], [0xc4, 0x01], [0x64, 0xaa], [0x00, 0x00]];
    const MACH: [[u8; 4]; 4] = [
        [0xfe, 0xed, 0xfa, 0xce],
        [0xfe, 0xed, 0xfa, 0xcf],
        [0xce, 0xfa, 0xed, 0xfe],
        [0xcf, 0xfa, 0xed, 0xfe],
    ];
    let head = bytes.get(..20).unwrap_or(bytes);
    if bytes.starts_with(b"\x7fELF") || MACH.iter().any(|magic| bytes.starts_with(magic)) {
        return Some("compiled object code (ELF or Mach-O)");
    }
    if bytes.starts_with(b"!<arch>") {
        return Some("an archive of compiled object code");
    }
    if COFF.iter().any(|machine| bytes.starts_with(machine)) && head.contains(&0) {
        return Some("compiled object code (COFF)");
    }
    // The first record of Intel's OMF, a module header.
    (bytes.first() == Some(&0x80) && head.contains(&0)).then_some("compiled object code (OMF)")
}

/// Whether a path leaves the folder of the file: absolute, with a drive, on a network share, or upwards.
pub(super) fn escapes_folder(path: &[u8]) -> bool {
    let is_separator = |b: &u8| matches!(b, b'/' | b'\\');
    path.first().is_some_and(is_separator)
        || path.contains(&b':')
        || path.split(is_separator).any(|part| part == b"..")
}
