//! `PackedBytes`: a stream, read from its front.

/// The rest of a stream, read from its front.
pub(super) struct PackedBytes<'a>(pub &'a [u8]);

impl<'a> PackedBytes<'a> {
    /// The next bytes.
    pub fn take(&mut self, n: usize) -> Result<&'a [u8], String> {
        let (taken, rest) = self.0.split_at_checked(n).ok_or_else(too_short)?;
        self.0 = rest;
        Ok(taken)
    }

    /// The next byte.
    pub fn byte(&mut self) -> Result<u8, String> {
        let (first, rest) = self.0.split_first().ok_or_else(too_short)?;
        self.0 = rest;
        Ok(*first)
    }

    /// The next number in unsigned LEB128: seven bits a byte, the lowest first, at most 32 bits.
    pub fn leb128(&mut self) -> Result<u32, String> {
        let mut value = 0;
        for shift in [0, 7, 14, 21, 28] {
            let byte = self.byte()?;
            let bits = u32::from(byte & 0x7F);
            if shift == 28 && bits > 0xF {
                break;
            }
            value |= bits << shift;
            if byte & 0x80 == 0 {
                return Ok(value);
            }
        }
        Err("a number has more than 32 bits".to_owned())
    }

    /// Checks that no bytes are left.
    pub fn end(&self) -> Result<(), String> {
        if self.0.is_empty() { Ok(()) } else { Err(format!("{} bytes are left over", self.0.len())) }
    }
}

/// Splits a stream into its header, its body and its tail; checks the header, whose low four bits are the
/// version.
pub(super) fn split(
    stream: &[u8],
    header: u8,
    n_tail: impl Fn(u8) -> usize,
) -> Result<(u8, &[u8], &[u8]), String> {
    let (first, rest) = stream.split_first().ok_or_else(too_short)?;
    let version = first & 0x0F;
    if first & 0xF0 != header || version > 1 {
        return Err(format!(
            "the stream begins with {first:#04x} and not with {header:#04x} or {:#04x}",
            header + 1
        ));
    }
    let n_body = rest.len().checked_sub(n_tail(version)).ok_or_else(too_short)?;
    let (body, tail) = rest.split_at(n_body);
    Ok((version, body, tail))
}

fn too_short() -> String {
    "the stream ends too early".to_owned()
}
