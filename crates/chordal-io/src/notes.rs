//! `NamedNotes`: notes on a file, each with the names of the objects that it concerns.
use crate::FileLocation;
use crate::warnings::Warnings;

/// The most names that a note lists; more are only counted. Chosen: a longer list makes the note hard to
/// read.
const LISTED: usize = 8;

/// The most characters of a name that a note shows. Chosen: larger values let one name fill the note.
const SHOWN: usize = 100;

struct NamedNote {
    code: &'static str,
    what: &'static str,
    count: u64,
    names: Vec<String>,
    n_others: u64,
}

/// Notes, one for each code.
#[derive(Default)]
pub(crate) struct NamedNotes {
    list: Vec<NamedNote>,
}

impl NamedNotes {
    /// Counts an occurrence, and lists its name if it is new.
    pub fn add(&mut self, code: &'static str, what: &'static str, name: &str) {
        let at = self.list.iter().position(|note| note.code == code).unwrap_or_else(|| {
            self.list.push(NamedNote { code, what, count: 0, names: Vec::new(), n_others: 0 });
            self.list.len() - 1
        });
        let note = &mut self.list[at];
        note.count += 1;
        let shown: String = name.chars().take(SHOWN).collect();
        let name = shown.escape_debug().to_string();
        if note.names.contains(&name) {
            return;
        }
        if note.names.len() < LISTED {
            note.names.push(name);
        } else {
            note.n_others += 1;
        }
    }

    /// Adds the notes as warnings of the file.
    pub fn report(self, warnings: &mut Warnings) {
        for note in self.list {
            let others =
                if note.n_others > 0 { format!(" and {} more", note.n_others) } else { String::new() };
            let message = format!("{}: {}{others}", note.what, note.names.join(", "));
            warnings.count_many(note.code, note.count, || (FileLocation::File, message));
        }
    }
}
