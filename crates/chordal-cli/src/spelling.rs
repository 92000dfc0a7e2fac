//! `CommandLine`: how the command spells settings, as options.
use chordal::budget::advice::{Setting, Spelling};

/// Settings as options of the command. Every shell spells certificates so, for their bytes are the same
/// wherever they are made.
#[derive(Clone, Copy, Debug)]
pub struct CommandLine;

impl Spelling for CommandLine {
    fn spell(&self, setting: Setting, value: Option<&str>) -> String {
        let option = format!("--{}", setting.name());
        match (setting, value) {
            // Fields are made in Python as often as in scripts, and the package has the command, too.
            (Setting::Region, Some(corners)) => format!("{option} \"{corners}\", in Python within()"),
            (Setting::View, Some(view)) => format!("{option} \"{view}\""),
            // Their values may be left out, so that the sign has to tie one.
            (Setting::Cure(_), Some(value)) => format!("{option}={value}"),
            (_, Some(value)) => format!("{option} {value}"),
            (_, None) => option,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_follow_their_option() {
        assert_eq!(CommandLine.spell(Setting::Unit, Some("mm")), "--unit mm");
        let region = CommandLine.spell(Setting::Region, Some("0,0,0 1,1,1"));
        assert!(region.starts_with("--region \"0,0,0 1,1,1\""), "{region}");
    }
}
