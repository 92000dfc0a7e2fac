//! The digest that ties a certificate to the bytes it describes.
use sha2::{Digest, Sha256};
use std::io::{self, Read};

/// SHA-256 in lower-case hexadecimal.
///
/// Source: FIPS 180-4.
#[must_use]
pub fn sha256(bytes: &[u8]) -> String {
    hexadecimal(&Sha256::digest(bytes))
}

/// The SHA-256 of everything in a reader, which is held in memory a piece at a time.
///
/// # Errors
/// If the reader fails.
pub fn sha256_of(reader: &mut dyn Read) -> io::Result<String> {
    let mut piece = vec![0; PIECE];
    let mut digest = Sha256::new();
    loop {
        match reader.read(&mut piece) {
            Ok(0) => return Ok(hexadecimal(&digest.finalize())),
            Ok(n) => digest.update(&piece[..n]),
            Err(error) if error.kind() == io::ErrorKind::Interrupted => {}
            Err(error) => return Err(error),
        }
    }
}

/// A digest of numbers, which are gathered so that each call of the hash gets many.
pub(crate) struct Sha256Stream {
    hash: Sha256,
    buffer: Vec<u8>,
}

impl Sha256Stream {
    /// An empty digest for one kind of shape.
    pub fn new(kind: &str) -> Self {
        let mut hash = Sha256::new();
        hash.update(kind.as_bytes());
        Self { hash, buffer: Vec::with_capacity(PIECE) }
    }

    /// Adds numbers, the least byte of each first.
    pub fn add(&mut self, numbers: &[u64]) {
        numbers.iter().for_each(|number| self.buffer.extend_from_slice(&number.to_le_bytes()));
        if self.buffer.len() >= PIECE {
            self.hash.update(&self.buffer);
            self.buffer.clear();
        }
    }

    /// The digest in hexadecimal.
    pub fn finish(mut self) -> String {
        self.hash.update(&self.buffer);
        hexadecimal(&self.hash.finalize())
    }
}

/// Bytes that are read at once. Chosen: so that system calls cost little beside the digest.
const PIECE: usize = 1 << 18;

fn hexadecimal(bytes: &[u8]) -> String {
    let digits = |byte: u8| [byte >> 4, byte & 15].map(|d| char::from(b"0123456789abcdef"[d as usize]));
    bytes.iter().flat_map(|byte| digits(*byte)).collect()
}

#[cfg(test)]
mod tests {
    #[test]
    fn digests_as_the_standard_says() {
        assert_eq!(super::sha256(b"abc"), "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
        let long = vec![7; 3 * super::PIECE + 1];
        assert_eq!(super::sha256_of(&mut &long[..]).unwrap(), super::sha256(&long));
    }
}
