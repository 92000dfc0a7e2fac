//! The digest that ties a certificate to the bytes it describes.
use sha2::{Digest, Sha256};

/// SHA-256 in lower-case hexadecimal.
///
/// Source: FIPS 180-4.
#[must_use]
pub fn sha256(bytes: &[u8]) -> String {
    let digits = |byte: u8| [byte >> 4, byte & 15].map(|d| char::from(b"0123456789abcdef"[d as usize]));
    Sha256::digest(bytes).iter().flat_map(|byte| digits(*byte)).collect()
}

#[cfg(test)]
mod tests {
    #[test]
    fn digests_as_the_standard_says() {
        assert_eq!(super::sha256(b"abc"), "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
    }
}
