//! `Secret`: 192 bits that nobody can guess, compared in constant time.
use subtle::ConstantTimeEq;

/// Bytes of a random secret: 192 bits.
const BYTES: usize = 24;

/// A token or a cookie. It prints nothing of itself by accident: there is no `Debug`.
pub struct Secret(String);

impl Secret {
    /// A new one from the system's source of random numbers, as 48 hexadecimal digits.
    ///
    /// # Errors
    /// When the system has no such source.
    pub fn random() -> Result<Self, getrandom::Error> {
        let mut bytes = [0; BYTES];
        getrandom::fill(&mut bytes)?;
        Ok(Self(bytes.iter().map(|byte| format!("{byte:02x}")).collect()))
    }

    /// The one that the user chose.
    pub fn from_text(text: &str) -> Self {
        Self(text.to_owned())
    }

    /// For the link and for the cookie.
    pub fn text(&self) -> &str {
        &self.0
    }

    /// Whether `other` is the same. The time it takes depends on the lengths alone.
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
