//! `GltfLint`: reports the errors of the Khronos validator, with the same codes and JSON pointers.
//!
//! The rules are those of gltf-validator 2.0.0-dev.3.10, one file for each kind of object. Parsing fills the
//! [`GltfModel`](super::model::GltfModel), with `None` for invalid fields; then links and data are checked.
use super::json::JsonValue;
use crate::{FileLocation, Warning};
use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write;

mod accessors;
mod animations;
mod buffers;
mod cameras;
mod elements;
mod extensions;
mod images;
mod materials;
mod meshes;
mod nodes;
mod packed_views;
mod root;
mod skins;
mod uri;

pub(super) use nodes::is_unit_quaternion;
pub(super) use root::{link, parse};

/// One step of a JSON pointer.
#[derive(Clone, Copy)]
pub(super) enum PointerToken<'a> {
    Key(&'a str),
    Index(usize),
}

impl<'a> From<&'a str> for PointerToken<'a> {
    fn from(key: &'a str) -> Self {
        Self::Key(key)
    }
}

impl From<usize> for PointerToken<'_> {
    fn from(index: usize) -> Self {
        Self::Index(index)
    }
}

/// The issues of a file, counted by their code, and the current JSON pointer.
pub(super) struct GltfLint<'a> {
    path: Vec<PointerToken<'a>>,
    /// Each code once, in the order of first occurrence.
    pub issues: Vec<Warning>,
    declared: BTreeSet<&'a str>,
    /// The lists of the document, to resolve references.
    lists: BTreeMap<&'a str, &'a [JsonValue]>,
    /// The extensions of the document itself.
    root_extensions: Option<&'a JsonValue>,
    /// The number of bytes that may still be checked: many objects may refer to the same data.
    work: u64,
}

/// The rule for an integer field.
#[derive(Clone, Copy, Default)]
struct IntegerRule {
    min: u64,
    max: Option<u64>,
    /// The allowed values; empty if all are. The validator only warns about others.
    list: &'static [u64],
    required: bool,
}

/// The rule for a number field: `min ≤ x ≤ max`, `above < x`, or `x` is the exception.
#[derive(Clone, Copy)]
struct NumberRule {
    min: f64,
    above: f64,
    max: f64,
    except: Option<f64>,
    required: bool,
}

impl NumberRule {
    const ANY: Self = Self {
        min: f64::NEG_INFINITY,
        above: f64::NEG_INFINITY,
        max: f64::INFINITY,
        except: None,
        required: false,
    };
    const AT_LEAST_0: Self = Self { min: 0.0, ..Self::ANY };
    const ABOVE_0: Self = Self { above: 0.0, ..Self::ANY };
    const UNIT: Self = Self { min: 0.0, max: 1.0, ..Self::ANY };

    const fn required(self) -> Self {
        Self { required: true, ..self }
    }
}

/// An optional field.
#[derive(Clone, Copy, PartialEq)]
enum JsonMember<T> {
    Absent,
    /// Present, but invalid.
    Bad,
    Is(T),
}

impl<T> JsonMember<T> {
    fn or(self, default: T) -> Option<T> {
        match self {
            Self::Absent => Some(default),
            Self::Bad => None,
            Self::Is(x) => Some(x),
        }
    }

    fn value(self) -> Option<T> {
        if let Self::Is(x) = self { Some(x) } else { None }
    }
}

impl<'a> GltfLint<'a> {
    /// A linter for a document; at most `work` bytes of its data are checked.
    pub fn new(root: &'a JsonValue, work: u64) -> Self {
        let lists = root.entries().iter().filter_map(|(key, value)| Some((&**key, value.items()?))).collect();
        Self {
            path: Vec::new(),
            issues: Vec::new(),
            declared: BTreeSet::new(),
            lists,
            root_extensions: root.get("extensions"),
            work,
        }
    }

    /// Extends the limit for another file of `bytes` bytes, as for the first.
    pub fn allow(&mut self, bytes: u64) {
        self.work = self.work.saturating_add(super::DECODED_PER_BYTE * bytes);
    }

    /// Charges bytes that are about to be checked. Returns false if they exceed the limit.
    fn charge(&mut self, bytes: u64) -> bool {
        let left = self.work.checked_sub(bytes);
        self.work = left.unwrap_or(0);
        if left.is_none() {
            self.issue_here(
                "too-large",
                "objects name the same bytes so often that they were not all looked at",
            );
        }
        left.is_some()
    }

    /// Reports an issue at the current pointer, or one step below it.
    fn issue(
        &mut self,
        code: &'static str,
        below: Option<PointerToken<'_>>,
        message: impl FnOnce() -> String,
    ) {
        if !self.count_repeat(code) {
            let place = FileLocation::Pointer(self.pointer(below));
            self.issues.push(Warning { code, count: 1, place, message: message().into() });
        }
    }

    /// Reports an issue at a stored pointer.
    pub fn issue_at(&mut self, code: &'static str, pointer: &str, message: impl FnOnce() -> String) {
        if !self.count_repeat(code) {
            let place = FileLocation::Pointer(pointer.to_owned());
            self.issues.push(Warning { code, count: 1, place, message: message().into() });
        }
    }

    /// Counts an issue whose code was reported before. Returns false for a new code.
    fn count_repeat(&mut self, code: &'static str) -> bool {
        let known = self.issues.iter_mut().find(|issue| issue.code == code);
        known.map(|issue| issue.count += 1).is_some()
    }

    fn issue_below(&mut self, code: &'static str, below: impl Into<PointerToken<'a>>, message: &str) {
        self.issue(code, Some(below.into()), || message.to_owned());
    }

    fn issue_here(&mut self, code: &'static str, message: &str) {
        self.issue(code, None, || message.to_owned());
    }

    /// Visits one step below the current pointer.
    fn within<R>(&mut self, step: impl Into<PointerToken<'a>>, look: impl FnOnce(&mut Self) -> R) -> R {
        self.path.push(step.into());
        let result = look(self);
        self.path.pop();
        result
    }

    fn pointer(&self, below: Option<PointerToken<'_>>) -> String {
        let mut out = String::new();
        for step in self.path.iter().copied().chain(below) {
            // Writing to a string cannot fail.
            let _ = match step {
                PointerToken::Key(key) => write!(out, "/{}", key.replace('~', "~0").replace('/', "~1")),
                PointerToken::Index(index) => write!(out, "/{index}"),
            };
        }
        if out.is_empty() { "/".to_owned() } else { out }
    }

    /// Whether a list of the document has an object at an index.
    fn exists(&self, list: &str, index: usize) -> bool {
        matches!(self.lists.get(list).and_then(|items| items.get(index)), Some(JsonValue::Object(_)))
    }

    /// A reference into a list; `None` if it is absent or not an index.
    fn reference(&mut self, map: &'a JsonValue, key: &'a str, list: &str) -> Option<usize> {
        let index = self.index(map, key, false)?;
        self.resolved(list, index, key.into());
        Some(index)
    }

    /// Reports a reference that does not resolve.
    fn resolved(&mut self, list: &str, index: usize, below: PointerToken<'a>) -> bool {
        let exists = self.exists(list, index);
        if !exists {
            self.issue("UNRESOLVED_REFERENCE", Some(below), || format!("{list} has no object {index}"));
        }
        exists
    }

    fn value(&mut self, map: &'a JsonValue, key: &'a str, expected: &str) -> Option<&'a JsonValue> {
        match map.get(key)? {
            JsonValue::Null => {
                self.mismatch(key, expected);
                None
            }
            value => Some(value),
        }
    }

    fn mismatch(&mut self, key: &'a str, expected: &str) {
        self.issue("TYPE_MISMATCH", Some(key.into()), || format!("{key} is no {expected}"));
    }

    fn missing(&mut self, key: &str) {
        self.issue("UNDEFINED_PROPERTY", None, || format!("property {key} is missing"));
    }

    fn index(&mut self, map: &'a JsonValue, key: &'a str, required: bool) -> Option<usize> {
        let Some(value) = self.value(map, key, "integer") else {
            if required {
                self.missing(key);
            }
            return None;
        };
        match value.integer() {
            Some(i) if i >= 0 => usize::try_from(i).ok(),
            Some(i) => {
                self.issue("INVALID_INDEX", Some(key.into()), || format!("{i} is no index"));
                None
            }
            None => {
                self.mismatch(key, "integer");
                None
            }
        }
    }

    fn integer(&mut self, map: &'a JsonValue, key: &'a str, rule: IntegerRule) -> JsonMember<u64> {
        let Some(value) = self.value(map, key, "integer") else {
            if rule.required {
                self.missing(key);
                return JsonMember::Bad;
            }
            return JsonMember::Absent;
        };
        let Some(i) = value.integer() else {
            self.mismatch(key, "integer");
            return JsonMember::Bad;
        };
        let value = u64::try_from(i).ok();
        if !rule.list.is_empty() {
            // The validator only warns about values outside a list, and ignores them.
            return value.filter(|x| rule.list.contains(x)).map_or(JsonMember::Bad, JsonMember::Is);
        }
        match value.filter(|x| *x >= rule.min && rule.max.is_none_or(|max| *x <= max)) {
            Some(x) => JsonMember::Is(x),
            None => {
                self.issue("VALUE_NOT_IN_RANGE", Some(key.into()), || format!("{key} {i} is out of range"));
                JsonMember::Bad
            }
        }
    }

    fn number(&mut self, map: &'a JsonValue, key: &'a str, rule: NumberRule) -> JsonMember<f64> {
        let Some(value) = self.value(map, key, "number") else {
            if rule.required {
                self.missing(key);
                return JsonMember::Bad;
            }
            return JsonMember::Absent;
        };
        let Some(x) = value.number() else {
            self.mismatch(key, "number");
            return JsonMember::Bad;
        };
        if rule.except == Some(x) || (x >= rule.min && x > rule.above && x <= rule.max) {
            return JsonMember::Is(x);
        }
        self.issue("VALUE_NOT_IN_RANGE", Some(key.into()), || format!("{key} {x} is out of range"));
        JsonMember::Bad
    }

    fn flag(&mut self, map: &'a JsonValue, key: &'a str) -> bool {
        match self.value(map, key, "boolean") {
            Some(JsonValue::Bool(flag)) => *flag,
            Some(_) => {
                self.mismatch(key, "boolean");
                false
            }
            None => false,
        }
    }

    fn text(&mut self, map: &'a JsonValue, key: &'a str, required: bool) -> Option<&'a str> {
        let Some(value) = self.value(map, key, "string") else {
            if required {
                self.missing(key);
            }
            return None;
        };
        if value.text().is_none() {
            self.mismatch(key, "string");
        }
        value.text()
    }

    fn name(&mut self, map: &'a JsonValue) -> &'a str {
        self.text(map, "name", false).unwrap_or_default()
    }

    /// An object member; `None` if it is absent or not an object.
    fn object(&mut self, map: &'a JsonValue, key: &'a str, required: bool) -> Option<&'a JsonValue> {
        let Some(value) = self.value(map, key, "object") else {
            if required {
                self.missing(key);
            }
            return None;
        };
        if !matches!(value, JsonValue::Object(_)) {
            self.mismatch(key, "object");
            return None;
        }
        Some(value)
    }

    /// A list member that is a non-empty array.
    fn list(&mut self, map: &'a JsonValue, key: &'a str) -> Option<&'a [JsonValue]> {
        let value = self.value(map, key, "array")?;
        match value.items() {
            Some([]) => {
                self.issue_below("EMPTY_ENTITY", key, "an empty list");
                None
            }
            Some(items) => Some(items),
            None => {
                self.mismatch(key, "array");
                None
            }
        }
    }

    /// A required list of objects.
    fn objects(&mut self, map: &'a JsonValue, key: &'a str) -> Option<&'a [JsonValue]> {
        if matches!(map.get(key), None | Some(JsonValue::Null)) {
            self.value(map, key, "array");
            self.missing(key);
            return None;
        }
        let items = self.list(map, key)?;
        let wrong = items.iter().filter(|item| !matches!(item, JsonValue::Object(_))).count();
        for _ in 0..wrong {
            self.issue_below("ARRAY_TYPE_MISMATCH", key, "an item is no object");
        }
        (wrong == 0).then_some(items)
    }

    /// A list of distinct indices, with `None` for invalid items.
    fn indices(&mut self, map: &'a JsonValue, key: &'a str, required: bool) -> Option<Vec<Option<usize>>> {
        if required && matches!(map.get(key), None | Some(JsonValue::Null)) {
            self.missing(key);
        }
        let items = self.list(map, key)?;
        self.within(key, |lint| {
            let mut out = Vec::with_capacity(items.len());
            for (i, item) in items.iter().enumerate() {
                let index = item.integer().and_then(|x| usize::try_from(x).ok());
                if index.is_none() {
                    lint.issue_below("INVALID_INDEX", i, "the item is no index");
                }
                out.push(index);
            }
            let mut sorted: Vec<_> = out.iter().copied().enumerate().filter(|(_, x)| x.is_some()).collect();
            sorted.sort_unstable_by_key(|(i, x)| (*x, *i));
            for pair in sorted.windows(2).filter(|pair| pair[0].1 == pair[1].1) {
                lint.issue_below("DUPLICATE_ELEMENTS", pair[1].0, "the item is there twice");
                out[pair[1].0] = None;
            }
            Some(out)
        })
    }

    /// A list of numbers within a range, and of the given length unless that is 0.
    fn numbers(
        &mut self,
        map: &'a JsonValue,
        key: &'a str,
        length: usize,
        range: (f64, f64),
    ) -> Option<Vec<f64>> {
        let items = self.list(map, key)?;
        if length != 0 && items.len() != length {
            self.issue("ARRAY_LENGTH_NOT_IN_LIST", Some(key.into()), || {
                format!("{key} has {} numbers where {length} are needed", items.len())
            });
            return None;
        }
        let mut all_good = true;
        let mut out = Vec::with_capacity(items.len());
        for (i, item) in items.iter().enumerate() {
            match item.number() {
                Some(x) if x >= range.0 && x <= range.1 => out.push(x),
                Some(x) => {
                    all_good = false;
                    self.within(key, |lint| {
                        lint.issue("VALUE_NOT_IN_RANGE", Some(i.into()), || format!("{x} is out of range"));
                    });
                }
                None => {
                    all_good = false;
                    self.issue_below("ARRAY_TYPE_MISMATCH", key, "an item is no number");
                }
            }
        }
        all_good.then_some(out)
    }

    /// A list of `N` numbers of any range.
    fn any_numbers<const N: usize>(&mut self, map: &'a JsonValue, key: &'a str) -> Option<[f64; N]> {
        self.numbers(map, key, N, ANY)?.try_into().ok()
    }

    /// A list of distinct strings.
    fn texts(&mut self, map: &'a JsonValue, key: &'a str) -> Vec<&'a str> {
        let Some(items) = self.list(map, key) else { return Vec::new() };
        self.within(key, |lint| {
            let mut out: Vec<&str> = Vec::with_capacity(items.len());
            for (i, item) in items.iter().enumerate() {
                match item.text() {
                    Some(text) => out.push(text),
                    None => lint.issue_below("ARRAY_TYPE_MISMATCH", i, "the item is no string"),
                }
            }
            let n = out.len();
            let mut sorted = out.clone();
            sorted.sort_unstable();
            if let Some(twice) = sorted.windows(2).find(|pair| pair[0] == pair[1]) {
                let second = items.iter().rposition(|item| item.text() == Some(twice[0]));
                lint.issue_below("DUPLICATE_ELEMENTS", second.unwrap_or_default(), "the item is there twice");
            }
            if n < items.len() { Vec::new() } else { out }
        })
    }
}

/// The range of all numbers.
const ANY: (f64, f64) = (f64::NEG_INFINITY, f64::INFINITY);
