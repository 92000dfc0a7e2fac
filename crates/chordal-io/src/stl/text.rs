//! Reads STL text: solids of facets, with keywords in any case.
use super::facets::StlFacets;
use crate::groups::Groups;
use crate::text::{number, number_error, show, text_of};
use crate::word_reader::WordReader;
use crate::{Content, FileLocation, Frame, Limits, ReadError, ReadOutcome, Scene};

/// Reads the facets of all solids.
pub(super) fn read(bytes: &[u8], limits: &Limits) -> Result<ReadOutcome, ReadError> {
    let mut reader = StlTextReader { words: WordReader::new(text_of(bytes)?), facets: StlFacets::default() };
    let (mut solids, mut n_solids, mut name) = (Groups::default(), 0_u64, String::new());
    let mut open: Option<FileLocation> = None;
    while let Some(word) = reader.words.next() {
        if is(word, "solid") {
            reader.count_open(open.replace(reader.words.place()));
            let title = String::from_utf8_lossy(reader.words.rest_of_line()).into_owned();
            solids.begin(&title, reader.facets.len())?;
            // With several solids, the titles are names of groups instead.
            name = if n_solids == 0 { title } else { String::new() };
            n_solids += 1;
        } else if is(word, "facet") {
            reader.facet(limits)?;
        } else if is(word, "endsolid") {
            reader.words.rest_of_line();
            open = None;
        } else {
            return Err(reader.unexpected(word, "'facet', 'endsolid' or 'solid'"));
        }
    }
    reader.count_open(open);
    let attribute = if n_solids > 1 { solids.attribute("solid", reader.facets.len())? } else { None };
    let has_groups = attribute.is_some();
    let (mesh, warnings) = reader.facets.into_mesh(attribute, limits)?;
    let mut scene = Scene::from_triangle_soup(&name, mesh, Frame::default());
    if has_groups {
        scene.groups.insert("solid".to_owned(), solids.into_names());
    }
    Ok(ReadOutcome { content: Content::Scene(scene), warnings: warnings.into_list() })
}

fn is(word: &[u8], keyword: &str) -> bool {
    word.eq_ignore_ascii_case(keyword.as_bytes())
}

struct StlTextReader<'a> {
    words: WordReader<'a>,
    facets: StlFacets,
}

impl StlTextReader<'_> {
    fn unexpected(&self, word: &[u8], expected: &str) -> ReadError {
        let message = format!("{} where {expected} should stand", show(word));
        ReadError::new("unexpected-word", self.words.place(), message)
    }

    fn count_open(&mut self, open: Option<FileLocation>) {
        if let Some(place) = open {
            self.facets
                .warnings
                .count("endsolid-missing", || (place, "solids do not end with 'endsolid'".to_owned()));
        }
    }

    fn keyword(&mut self, keyword: &str) -> Result<(), ReadError> {
        let word = self.words.expect(|| format!("'{keyword}'"))?;
        if is(word, keyword) { Ok(()) } else { Err(self.unexpected(word, &format!("'{keyword}'"))) }
    }

    fn numbers(&mut self, what: &str, other: fn(&[u8]) -> Option<f64>) -> Result<[f64; 3], ReadError> {
        let mut values = [0.0; 3];
        for value in &mut values {
            let word = self.words.expect(|| format!("the coordinates of a {what}"))?;
            *value = number(word).or_else(|| other(word)).ok_or_else(|| {
                ReadError::new("not-a-number", self.words.place(), format!("{what}: {}", number_error(word)))
            })?;
        }
        Ok(values)
    }

    fn facet(&mut self, limits: &Limits) -> Result<(), ReadError> {
        self.keyword("normal")?;
        // C runtimes print NaN as `-nan(ind)` and the like. A normal that is NaN is only counted.
        let nan = |word: &[u8]| word.to_ascii_lowercase().windows(3).any(|w| w == b"nan").then_some(f64::NAN);
        let normal = self.numbers("normal", nan)?;
        self.keyword("outer")?;
        self.keyword("loop")?;
        let (mut corners, mut n) = ([[0.0; 3]; 3], 0);
        loop {
            let word = self.words.expect(|| "'vertex' or 'endloop'".to_owned())?;
            if is(word, "endloop") {
                break;
            }
            if !is(word, "vertex") {
                return Err(self.unexpected(word, "'vertex' or 'endloop'"));
            }
            if n == 3 {
                return Err(self.wrong_width("more than 3"));
            }
            corners[n] = self.numbers("vertex", |_| None)?;
            n += 1;
        }
        if n < 3 {
            return Err(self.wrong_width(&format!("only {n}")));
        }
        self.keyword("endfacet")?;
        let Self { words, facets } = self;
        facets.push(corners, normal, || words.place(), limits)
    }

    fn wrong_width(&self, actual: &str) -> ReadError {
        let message = format!("a facet has {actual} vertices where 3 are needed");
        ReadError::new("wrong-width", self.words.place(), message)
    }
}
