//! `EncodedBytes`: the bytes of a data array, plain or as base64, read in pieces.
use super::array_place::ArrayPlace;
use crate::ReadError;
use crate::grow::with_room;
use crate::text::{grouped, is_space};
use std::borrow::Cow;

/// The value of a character that is not in base64, and of the padding.
const NONE: u8 = 0xff;
const PADDING: u8 = 0xfe;

/// The value of each character (RFC 4648, section 4).
const VALUES: [u8; 256] = {
    let mut values = [NONE; 256];
    let alphabet = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let mut i = 0;
    while i < alphabet.len() {
        values[alphabet[i] as usize] = i as u8;
        i += 1;
    }
    values[b'=' as usize] = PADDING;
    values
};

/// The encoding of bytes in a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum BytePacking {
    /// Unencoded.
    Raw,
    /// As base64, in one run or several, each with its own padding.
    Base64,
}

/// A cursor over bytes.
#[derive(Clone, Debug)]
pub(crate) struct EncodedBytes<'a> {
    bytes: &'a [u8],
    at: usize,
    packing: BytePacking,
    /// Decoded bytes that were not requested yet.
    spare: [u8; 3],
    n_spare: usize,
    /// The position of the first byte, or in text that of the array.
    place: ArrayPlace<'a>,
}

impl<'a> EncodedBytes<'a> {
    pub(crate) fn new(bytes: &'a [u8], packing: BytePacking, place: ArrayPlace<'a>) -> Self {
        Self { bytes, at: 0, packing, spare: [0; 3], n_spare: 0, place }
    }

    /// The position of the next byte, or in text that of the array.
    pub(crate) fn place(&self) -> ArrayPlace<'a> {
        self.place.after(self.at)
    }

    /// The number of bytes of the file that were read.
    pub(crate) fn n_taken(&self) -> u64 {
        self.at as u64
    }

    /// Whether nothing but space follows.
    pub(crate) fn is_blank(&self) -> bool {
        self.n_spare == 0 && self.bytes[self.at..].iter().all(|b| is_space(*b))
    }

    /// The most bytes that can follow.
    pub(crate) fn n_left(&self) -> u64 {
        let left = (self.bytes.len() - self.at) as u64;
        match self.packing {
            BytePacking::Raw => left,
            // Four characters encode three bytes.
            BytePacking::Base64 => self.n_spare as u64 + left / 4 * 3,
        }
    }

    /// The next `n` bytes.
    ///
    /// # Errors
    /// `truncated` if there are too few, `bad-base64`.
    pub(crate) fn take(&mut self, n: u64) -> Result<Cow<'a, [u8]>, ReadError> {
        if n > self.n_left() {
            return Err(self.cut_off(n));
        }
        // The remaining bytes are already in memory, so the number fits.
        let n = n as usize;
        match self.packing {
            BytePacking::Raw => {
                let taken = &self.bytes[self.at..self.at + n];
                self.at += n;
                Ok(Cow::Borrowed(taken))
            }
            BytePacking::Base64 => self.decode(n).map(Cow::Owned),
        }
    }

    /// All bytes up to the end, for base64.
    ///
    /// # Errors
    /// `bad-base64`, and `truncated` if it ends inside a group of characters.
    pub(crate) fn rest(&mut self) -> Result<Vec<u8>, ReadError> {
        let mut bytes = with_room(self.n_left() as usize)?;
        while !self.is_blank() {
            if self.n_spare == 0 {
                self.quartet(1)?;
            }
            bytes.extend_from_slice(&self.spare[..self.n_spare]);
            self.n_spare = 0;
        }
        Ok(bytes)
    }

    fn cut_off(&self, n: u64) -> ReadError {
        let message = format!(
            "the data array is cut off: {} bytes were to follow, and {} at most do",
            grouped(n),
            grouped(self.n_left())
        );
        ReadError::new("truncated", self.place().location(), message)
    }

    fn decode(&mut self, n: usize) -> Result<Vec<u8>, ReadError> {
        let mut decoded: Vec<u8> = with_room(n)?;
        while decoded.len() < n {
            if self.n_spare == 0 {
                self.quartet(n as u64)?;
            }
            // A part of the stream may end within a group of four characters; the rest of its three
            // bytes belongs to the next part.
            let more = self.n_spare.min(n - decoded.len());
            decoded.extend_from_slice(&self.spare[..more]);
            self.spare.copy_within(more.., 0);
            self.n_spare -= more;
        }
        Ok(decoded)
    }

    /// Decodes the next four characters, which encode one byte or more.
    #[inline]
    fn quartet(&mut self, requested: u64) -> Result<(), ReadError> {
        let mut values = [0; 4];
        let mut n_padding = 0;
        for value in &mut values {
            while self.bytes.get(self.at).is_some_and(|b| is_space(*b)) {
                self.at += 1;
            }
            let Some(byte) = self.bytes.get(self.at) else { return Err(self.cut_off(requested)) };
            *value = VALUES[usize::from(*byte)];
            match *value {
                NONE => return Err(self.bad("has a character that is none of its 64")),
                PADDING => n_padding += 1,
                _ if n_padding > 0 => return Err(self.bad("goes on after its padding")),
                _ => {}
            }
            self.at += 1;
        }
        if n_padding > 2 {
            return Err(self.bad("ends inside a byte"));
        }
        let [a, b, c, d] = values.map(|value| if value == PADDING { 0 } else { u32::from(value) });
        let [_, x, y, z] = (a << 18 | b << 12 | c << 6 | d).to_be_bytes();
        (self.spare, self.n_spare) = ([x, y, z], 3 - n_padding);
        Ok(())
    }

    fn bad(&self, what: &str) -> ReadError {
        ReadError::new("bad-base64", self.place().location(), format!("the base64 of a data array {what}"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn over(text: &str) -> EncodedBytes<'_> {
        EncodedBytes::new(text.as_bytes(), BytePacking::Base64, ArrayPlace::Byte(0))
    }

    #[test]
    fn runs_of_base64_follow_each_other() {
        // One run, two runs with padding between them, and line breaks.
        for text in ["AAECAwQF", "AAEC\nAw\r\nQF ", "AA==AQ==AgM=BAU="] {
            let mut bytes = over(text);
            assert_eq!(*bytes.take(1).unwrap(), [0], "{text}");
            assert_eq!(*bytes.take(4).unwrap(), [1, 2, 3, 4], "{text}");
            assert_eq!(*bytes.take(1).unwrap(), [5], "{text}");
            assert!(bytes.is_blank());
            assert_eq!(bytes.take(1).unwrap_err().code, "truncated");
        }
    }

    #[test]
    fn broken_base64_is_refused() {
        for (text, code) in
            [("AA-_", "bad-base64"), ("A===", "bad-base64"), ("AA=A", "bad-base64"), ("AA= ", "truncated")]
        {
            assert_eq!(over(text).take(1).unwrap_err().code, code, "{text}");
        }
    }
}
