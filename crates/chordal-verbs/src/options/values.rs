//! How the values of options are read.
use crate::formats::in_words;
use chordal::budget::attributes::AttributeLimits;
use chordal::budget::{InvalidLength, Length};

/// A length. The error is the reason alone: the message in which it stands names the text already.
///
/// # Errors
/// Why the text is no length.
pub fn length(text: &str) -> Result<Length, String> {
    text.parse().map_err(|error: InvalidLength| {
        let message = error.to_string();
        message.strip_prefix(&format!("'{}': ", text.trim())).unwrap_or(&message).to_owned()
    })
}

/// An angle in degrees.
///
/// # Errors
/// If it is not above 0 and at most 180.
pub fn angle(text: &str) -> Result<f64, String> {
    let number = text.strip_suffix("deg").unwrap_or(text).trim().parse();
    match number {
        Ok(angle) if angle > 0.0 && angle <= 180.0 => Ok(angle),
        _ => Err("an angle is above 0 and at most 180 degrees, as in 5deg".into()),
    }
}

/// A distance of an eye in the units of the shape.
///
/// # Errors
/// If it is not finite and above 0.
pub fn distance(text: &str) -> Result<f64, String> {
    match text.trim().parse::<f64>() {
        Ok(distance) if distance > 0.0 && distance.is_finite() => Ok(distance),
        _ => Err("a distance is a finite number greater than 0".to_owned()),
    }
}

/// A share from 0 on.
pub(super) fn share(text: &str) -> Result<f64, &'static str> {
    match text.parse::<f64>() {
        Ok(share) if share >= 0.0 && share.is_finite() => Ok(share),
        Ok(_) => Err("a share is 0 or more"),
        Err(_) => Err("expected a share like 0.1"),
    }
}

/// A whole number greater than 0.
///
/// # Errors
/// If the text is none.
pub fn count(text: &str) -> Result<u64, String> {
    match text.trim().parse() {
        Ok(count) if count > 0 => Ok(count),
        _ => Err("a whole number greater than 0".to_owned()),
    }
}

/// A whole number from 1 to `most`.
pub(super) fn count_up_to(text: &str, most: u64) -> Result<u64, String> {
    let count = text.trim().parse().ok().filter(|count| (1..=most).contains(count));
    count.ok_or_else(|| format!("a whole number from 1 to {most}"))
}

/// A whole number from 0 on.
pub(super) fn count_from_0<T: std::str::FromStr>(text: &str) -> Result<T, &'static str> {
    text.trim().parse().map_err(|_| "a whole number from 0 on")
}

/// A distance of texture coordinates, of which the side of a texture is 1.
pub(super) fn texcoord_distance(text: &str) -> Result<f64, String> {
    let (number, unit) = text.trim().strip_suffix('%').map_or((text.trim(), 1.0), |share| (share, 0.01));
    match number.trim().parse::<f64>().map(|number| number * unit) {
        Ok(distance) if AttributeLimits::new(Some(distance), None).is_ok() => Ok(distance),
        _ => Err("a distance of texture coordinates is above 0, as in 0.01 or 1%".into()),
    }
}

/// What a word stands for, by a list of words and their meanings.
pub(super) fn word<T: Copy>(text: &str, words: &[(&str, T)]) -> Result<T, String> {
    let meaning = words.iter().find(|(word, _)| *word == text).map(|(_, meaning)| *meaning);
    meaning.ok_or_else(|| {
        let names: Vec<String> = words.iter().map(|(word, _)| format!("'{word}'")).collect();
        format!("{}, not '{text}'", in_words(&names, "or"))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_are_listed_if_none_of_them_is_given() {
        assert_eq!(word("even", &[("fewest", 1), ("even", 2)]), Ok(2));
        assert_eq!(
            word("odd", &[("a", 1), ("b", 2), ("c", 3)]),
            Err("'a', 'b' or 'c', not 'odd'".to_owned())
        );
        assert_eq!(word("odd", &[("even", 2)]), Err("'even', not 'odd'".to_owned()));
    }

    #[test]
    fn counts_begin_at_one() {
        assert_eq!(count(" 7"), Ok(7));
        assert_eq!((count_up_to("9", 9), count_up_to("10", 9).is_err()), (Ok(9), true));
        for text in ["0", "-1", "1.5", "", "x"] {
            assert!(count(text).is_err() && count_up_to(text, 9).is_err(), "{text}");
        }
    }
}
