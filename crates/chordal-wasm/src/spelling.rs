//! `JsonKeys` and `AsCommand`: the spelling of settings in messages and in certificates.
use crate::options::keys;
use chordal::budget::advice::{Setting, Spelling};

/// Settings as keys of the options; settings without a key as options of the command.
pub(crate) struct JsonKeys;

impl Spelling for JsonKeys {
    fn spell(&self, setting: Setting, value: Option<&str>) -> String {
        let name = setting.name().replace('-', "_");
        match value {
            _ if !keys().any(|key| key == name) => {
                format!("{} of the command", AsCommand.spell(setting, value))
            }
            Some(value) if matches!(setting, Setting::Px | Setting::Triangles | Setting::Segments) => {
                format!("\"{name}\": {value}")
            }
            Some(value) => format!("\"{name}\": \"{value}\""),
            None => format!("\"{name}\""),
        }
    }
}

/// Settings in the spelling of the command, for certificates, whose bytes do not depend on where they are
/// made.
pub(crate) struct AsCommand;

impl Spelling for AsCommand {
    fn spell(&self, setting: Setting, value: Option<&str>) -> String {
        let value = value.map_or_else(String::new, |value| format!(" {value}"));
        format!("--{}{value}", setting.name())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn settings_are_keys_where_there_are_such() {
        assert_eq!(JsonKeys.spell(Setting::From, None), "\"from\"");
        assert_eq!(JsonKeys.spell(Setting::Segments, Some("5")), "\"segments\": 5");
        assert_eq!(JsonKeys.spell(Setting::Unit, Some("mm")), "\"unit\": \"mm\"");
        assert_eq!(JsonKeys.spell(Setting::UvError, Some("0.01")), "\"uv_error\": \"0.01\"");
        assert_eq!(JsonKeys.spell(Setting::Level, Some("2")), "--level 2 of the command");
    }
}
