//! `StyleSheet`: rules for elements, classes and ids; all other rules are counted.
use super::style::{StyleProperty, declarations};
use std::borrow::Cow;
use std::collections::BTreeMap;

/// The most rules of one sheet; more are dropped. Chosen: matching is linear in the rules that name one
/// class.
pub(super) const MOST_RULES: usize = 4096;

/// A selector of one element: `path`, `.a`, `#b`, `path.a.b`, `*`.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
struct CssSelector {
    element: Option<String>,
    id: Option<String>,
    classes: Vec<String>,
}

#[derive(Clone, Debug)]
struct CssRule {
    selector: CssSelector,
    property: StyleProperty,
    value: String,
}

/// All rules of a file, indexed by the names in their selectors.
#[derive(Debug, Default)]
pub(super) struct StyleSheet {
    rules: Vec<CssRule>,
    /// Indices of the rules whose selector names this id (`#…`), class (`.…`) or element, or no name (empty).
    by_name: BTreeMap<String, Vec<u32>>,
    /// The number of unsupported selectors and at-rules.
    pub unsupported: u64,
    /// The number of rules over the limit.
    pub dropped: u64,
}

/// The properties of an element that selectors match.
#[derive(Debug)]
pub(super) struct SelectorSubject<'a> {
    pub element: &'a str,
    pub id: Option<Cow<'a, str>>,
    pub class: Option<Cow<'a, str>>,
}

impl StyleSheet {
    pub fn is_empty(&self) -> bool {
        self.rules.is_empty()
    }

    /// Adds a sheet.
    pub fn add(&mut self, text: &str) {
        let text = without_comments(text);
        let mut rest = text.trim_start();
        while !rest.is_empty() {
            if rest.starts_with('@') {
                self.unsupported += 1;
                rest = after_at_rule(rest).trim_start();
                continue;
            }
            let Some((selectors, after)) = rest.split_once('{') else { break };
            let (body, after) = after.split_once('}').unwrap_or((after, ""));
            self.add_rule(selectors, body);
            rest = after.trim_start();
        }
    }

    fn add_rule(&mut self, selectors: &str, body: &str) {
        for one in selectors.split(',') {
            let Some(selector) = CssSelector::read(one.trim()) else {
                self.unsupported += 1;
                continue;
            };
            for (name, value) in declarations(body) {
                let Some(property) = StyleProperty::from_name(&name.to_ascii_lowercase()) else { continue };
                if self.rules.len() >= MOST_RULES {
                    self.dropped += 1;
                    continue;
                }
                let index = self.rules.len() as u32;
                self.by_name.entry(selector.key()).or_default().push(index);
                self.rules.push(CssRule { selector: selector.clone(), property, value: value.to_owned() });
            }
        }
    }

    /// The declarations for an element, weakest first.
    pub fn matching(&self, named: &SelectorSubject) -> Vec<(StyleProperty, &str)> {
        let classes: Vec<&str> = named.class.as_deref().unwrap_or("").split_ascii_whitespace().collect();
        let mut keys: Vec<String> = classes.iter().map(|class| format!(".{class}")).collect();
        keys.sort();
        keys.dedup();
        keys.extend(named.id.iter().map(|id| format!("#{id}")));
        keys.push(named.element.to_owned());
        keys.push(String::new());
        let mut rules: Vec<u32> =
            keys.iter().filter_map(|key| self.by_name.get(key)).flatten().copied().collect();
        rules.retain(|rule| self.rules[*rule as usize].selector.fits(named, &classes));
        rules.sort_by_key(|rule| (self.rules[*rule as usize].selector.weight(), *rule));
        rules
            .iter()
            .map(|rule| &self.rules[*rule as usize])
            .map(|rule| (rule.property, rule.value.as_str()))
            .collect()
    }
}

impl CssSelector {
    /// Parses a selector. `None` if it refers to more than the names of one element.
    fn read(text: &str) -> Option<Self> {
        let is_plain = |c: char| c.is_alphanumeric() || matches!(c, '-' | '_' | '.' | '#' | '*');
        if text.is_empty() || !text.chars().all(is_plain) {
            return None;
        }
        let mut selector = Self::default();
        let starts: Vec<usize> =
            text.char_indices().filter(|(_, c)| matches!(c, '.' | '#')).map(|(i, _)| i).collect();
        let head = &text[..starts.first().copied().unwrap_or(text.len())];
        selector.element = (!head.is_empty() && head != "*").then(|| head.to_owned());
        for (i, start) in starts.iter().enumerate() {
            let end = starts.get(i + 1).copied().unwrap_or(text.len());
            let name = text.get(start + 1..end).filter(|name| !name.is_empty())?.to_owned();
            if text[*start..].starts_with('.') {
                selector.classes.push(name);
            } else if selector.id.replace(name).is_some() {
                return None;
            }
        }
        Some(selector)
    }

    fn key(&self) -> String {
        match (&self.id, self.classes.first(), &self.element) {
            (Some(id), _, _) => format!("#{id}"),
            (None, Some(class), _) => format!(".{class}"),
            (None, None, Some(element)) => element.clone(),
            (None, None, None) => String::new(),
        }
    }

    fn weight(&self) -> (bool, usize, bool) {
        (self.id.is_some(), self.classes.len(), self.element.is_some())
    }

    fn fits(&self, named: &SelectorSubject, classes: &[&str]) -> bool {
        self.element.as_deref().is_none_or(|element| element == named.element)
            && self.id.as_deref().is_none_or(|id| named.id.as_deref() == Some(id))
            && self.classes.iter().all(|class| classes.contains(&class.as_str()))
    }
}

fn without_comments(text: &str) -> String {
    let mut kept = String::new();
    let mut rest = text;
    while let Some((before, after)) = rest.split_once("/*") {
        kept.push_str(before);
        kept.push(' ');
        rest = after.split_once("*/").map_or("", |(_, after)| after);
    }
    kept.push_str(rest);
    // Old pages wrap sheets in comments to hide them from old browsers.
    kept.replace("<!--", " ").replace("-->", " ")
}

/// The text after an at-rule: after its semicolon, or after its block with all nested blocks.
fn after_at_rule(text: &str) -> &str {
    let mut depth = 0_u32;
    for (at, c) in text.char_indices() {
        match c {
            ';' if depth == 0 => return &text[at + 1..],
            '{' => depth += 1,
            '}' if depth <= 1 => return &text[at + 1..],
            '}' => depth -= 1,
            _ => {}
        }
    }
    ""
}

#[cfg(test)]
mod tests {
    use super::*;

    fn matching_values(sheet: &str, element: &str, id: &str, class: &str) -> Vec<String> {
        let mut all = StyleSheet::default();
        all.add(sheet);
        let named = SelectorSubject { element, id: Some(id.into()), class: Some(class.into()) };
        all.matching(&named).iter().map(|(_, value)| (*value).to_owned()).collect()
    }

    #[test]
    fn stronger_selectors_come_later_and_then_the_order_of_the_file_counts() {
        let sheet = "#b{fill:1} .a{fill:2} path{fill:3} .a{fill:4} *{fill:5} path.a{fill:6} rect{fill:7}";
        assert_eq!(matching_values(sheet, "path", "b", "x a"), ["5", "3", "2", "4", "6", "1"]);
        assert_eq!(matching_values(sheet, "circle", "c", ""), ["5"]);
    }

    #[test]
    fn what_is_not_supported_is_counted_and_does_not_swallow_what_follows() {
        let mut all = StyleSheet::default();
        all.add("@import 'x'; @media print { .a { fill: red } } g > path {fill:none} a:hover{fill:1} /* x { */ .a{fill:2}");
        assert_eq!((all.unsupported, all.rules.len()), (4, 1));
        all.add("broken");
        all.add(".a { fill: url(x");
        assert_eq!(all.rules.len(), 2);
    }
}
