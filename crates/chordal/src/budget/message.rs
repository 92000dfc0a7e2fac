//! `Message`: a sentence for people that may advise settings, which every front end spells in its own way.
use super::Setting;
use std::fmt;
use std::ops::{Deref, Range};

/// A sentence for people, and the places where it advises settings.
///
/// Its own text has the names of settings in quotes. A front end replaces them by its [`Spelling`], with
/// [`Spell::spelled`].
///
/// ```
/// use chordal::budget::advice::{Message, Setting, Spell, Spelling};
///
/// struct Keywords;
/// impl Spelling for Keywords {
///     fn spell(&self, setting: Setting, value: Option<&str>) -> String {
///         format!("{}={}", setting.name(), value.unwrap_or("…"))
///     }
/// }
///
/// let message = Message::from("no surface: ").value(Setting::Iso, 0.5).words(" gives one");
/// assert_eq!(message, "no surface: 'iso=0.5' gives one");
/// assert_eq!(message.spelled(&Keywords), "no surface: iso=0.5 gives one");
/// ```
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Message {
    text: String,
    /// In the order of the text, without overlap.
    advice: Vec<SettingSpan>,
}

/// A setting in a sentence.
#[derive(Clone, Debug, PartialEq, Eq)]
struct SettingSpan {
    /// Its bytes in the text.
    range: Range<usize>,
    setting: Setting,
    value: Option<String>,
}

impl Message {
    /// The sentence with more words at its end.
    #[must_use]
    pub fn words(mut self, words: impl fmt::Display) -> Self {
        self.text.push_str(&words.to_string());
        self
    }

    /// The sentence with a setting at its end.
    #[must_use]
    pub fn setting(self, setting: Setting) -> Self {
        self.advise(setting, None, format!("'{}'", setting.name()))
    }

    /// The sentence with a setting and its value at its end.
    #[must_use]
    pub fn value(self, setting: Setting, value: impl fmt::Display) -> Self {
        let value = value.to_string();
        let neutral = format!("'{}={value}'", setting.name());
        self.advise(setting, Some(value), neutral)
    }

    /// The sentence followed by another one, with its settings.
    #[must_use]
    pub fn message(mut self, other: &Self) -> Self {
        let shift = self.text.len();
        self.text.push_str(&other.text);
        self.advice.extend(other.advice.iter().cloned().map(|span| {
            let range = span.range.start + shift..span.range.end + shift;
            SettingSpan { range, ..span }
        }));
        self
    }

    fn advise(mut self, setting: Setting, value: Option<String>, text: String) -> Self {
        let start = self.text.len();
        self.text.push_str(&text);
        self.advice.push(SettingSpan { range: start..self.text.len(), setting, value });
        self
    }
}

/// How a front end writes settings.
pub trait Spelling {
    /// The text by which its users set this, with the value if there is one.
    fn spell(&self, setting: Setting, value: Option<&str>) -> String;
}

/// A type that holds messages, whose settings can be spelled.
pub trait Spell: Sized {
    /// Spells all settings that are not spelled yet.
    fn spell(&mut self, spelling: &dyn Spelling);

    /// The same with all settings spelled.
    #[must_use]
    fn spelled(mut self, spelling: &dyn Spelling) -> Self {
        self.spell(spelling);
        self
    }
}

impl Spell for Message {
    fn spell(&mut self, spelling: &dyn Spelling) {
        // From the end, so that earlier ranges stay valid.
        for SettingSpan { range, setting, value } in std::mem::take(&mut self.advice).into_iter().rev() {
            self.text.replace_range(range, &spelling.spell(setting, value.as_deref()));
        }
    }
}

impl<T: Spell> Spell for Vec<T> {
    fn spell(&mut self, spelling: &dyn Spelling) {
        self.iter_mut().for_each(|each| each.spell(spelling));
    }
}

impl<T: Spell> Spell for Option<T> {
    fn spell(&mut self, spelling: &dyn Spelling) {
        self.iter_mut().for_each(|inner| inner.spell(spelling));
    }
}

impl<T: Spell, E: Spell> Spell for Result<T, E> {
    fn spell(&mut self, spelling: &dyn Spelling) {
        match self {
            Ok(result) => result.spell(spelling),
            Err(error) => error.spell(spelling),
        }
    }
}

impl From<String> for Message {
    fn from(text: String) -> Self {
        Self { text, advice: Vec::new() }
    }
}

impl From<&str> for Message {
    fn from(text: &str) -> Self {
        text.to_owned().into()
    }
}

impl Deref for Message {
    type Target = str;
    fn deref(&self) -> &str {
        &self.text
    }
}

impl fmt::Display for Message {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.text)
    }
}

impl PartialEq<str> for Message {
    fn eq(&self, other: &str) -> bool {
        self.text == other
    }
}

impl PartialEq<&str> for Message {
    fn eq(&self, other: &&str) -> bool {
        self.text == *other
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::budget::Cure;

    /// Settings as they might stand in a manual of another language.
    struct Brackets;

    impl Spelling for Brackets {
        fn spell(&self, setting: Setting, value: Option<&str>) -> String {
            format!("<{}:{}>", setting.name(), value.unwrap_or_default())
        }
    }

    #[test]
    fn several_settings_are_spelled_where_they_stand() {
        let orient = Setting::Cure(Cure::Orient);
        let inner = Message::from("é ").setting(Setting::Open).words(" or ").value(orient, 3);
        let outer = Message::from("a: ").setting(Setting::Unit).words("; ").message(&inner).words(".");
        assert_eq!(outer, "a: 'unit'; é 'open' or 'orient=3'.");
        let mut spelled = outer.spelled(&Brackets);
        assert_eq!(spelled, "a: <unit:>; é <open:> or <orient:3>.");
        spelled.spell(&Brackets);
        assert_eq!(spelled, "a: <unit:>; é <open:> or <orient:3>.", "a second front end changes nothing");
    }

    #[test]
    fn words_that_look_like_a_setting_are_left_alone() {
        let message = Message::from("'unit' of 'a.obj': ").setting(Setting::Unit);
        assert_eq!(message.spelled(&Brackets), "'unit' of 'a.obj': <unit:>");
    }

    #[test]
    fn names_of_settings_are_unique() {
        let plain = Setting::PLAIN.into_iter();
        let mut names: Vec<&str> = plain.chain(Cure::ALL.map(Setting::Cure)).map(Setting::name).collect();
        names.sort_unstable();
        names.dedup();
        assert_eq!(names.len(), Setting::PLAIN.len() + Cure::ALL.len());
    }
}
