//! `CommandLine`: how the command spells settings, as options.
use chordal::budget::advice::{Setting, Spelling};

/// Settings as options of the command. Python and the browser spell them so in certificates too: the bytes of
/// a certificate do not depend on where it was made.
#[derive(Clone, Copy, Debug)]
pub struct CommandLine;

impl Spelling for CommandLine {
    fn spell(&self, setting: Setting, value: Option<&str>) -> String {
        let option = format!("--{}", setting.name());
        match (setting, value) {
            // The command also comes with the Python package, where fields are often built without a script.
            (Setting::Region, Some(corners)) => format!("{option} \"{corners}\", in Python within()"),
            (Setting::View, Some(view)) => format!("{option} \"{view}\""),
            // Its value is optional, so it has to follow a `=`.
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
