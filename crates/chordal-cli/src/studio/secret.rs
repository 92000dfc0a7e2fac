//! `Secret`: 192 random bits, compared in constant time.
use subtle::ConstantTimeEq;

/// The bytes of a random secret. Chosen: 192 bits cannot be guessed.
const BYTES: usize = 24;

/// A token or a cookie. It has no `Debug`, so that it is never printed by accident.
pub struct Secret(String);

impl Secret {
    /// A new secret from the system's random numbers, as 48 hexadecimal digits.
    ///
    /// # Errors
    /// If the system has no random numbers.
    pub fn random() -> Result<Self, getrandom::Error> {
        let mut bytes = [0; BYTES];
        getrandom::fill(&mut bytes)?;
        Ok(Self(bytes.iter().map(|byte| format!("{byte:02x}")).collect()))
    }

    /// A secret that the user chose.
    pub fn from_text(text: &str) -> Self {
        Self(text.to_owned())
    }

    /// The text for the link or the cookie.
    pub fn text(&self) -> &str {
        &self.0
    }

    /// Whether `other` is the same. The time depends only on the lengths.
    pub fn matches(&self, other: &str) -> bool {
        self.0.as_bytes().ct_eq(other.as_bytes()).into()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn is_192_random_bits_as_hexadecimal_digits() {
        let [a, b] = [(); 2].map(|()| Secret::random().unwrap());
        assert_eq!(a.text().len(), 48);
        assert!(a.text().bytes().all(|byte| byte.is_ascii_hexdigit()));
        assert_ne!(a.text(), b.text());
    }

    #[test]
    fn knows_itself_and_nothing_else() {
        let secret = Secret::from_text("abc");
        assert!(secret.matches("abc"));
        for other in ["", "ab", "abd", "abcd", "ABC"] {
            assert!(!secret.matches(other), "{other}");
        }
    }
}
