//! `MtlMap`: the options and the picture of a map statement.
use crate::text::{LineTokens, number};

/// A map statement.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct MtlMap {
    /// The path of the picture in the file.
    pub path: String,
    /// How often the picture repeats over the unit square, by `-s`.
    pub scale: [f64; 2],
    /// The offset of texture coordinates, by `-o`.
    pub offset: [f64; 2],
    /// Whether the texture is clamped instead of repeated, by `-clamp`.
    pub is_clamped: bool,
    /// The bump multiplier, by `-bm`.
    pub steepness: Option<f64>,
    /// Options that glTF cannot express, as spelled in the file.
    pub others: String,
}

/// Options that are kept unchanged, each with its number of arguments.
const OTHERS: [(&str, usize); 9] = [
    ("-blendu", 1),
    ("-blendv", 1),
    ("-boost", 1),
    ("-cc", 1),
    ("-imfchan", 1),
    ("-mm", 2),
    ("-t", 3),
    ("-texres", 1),
    ("-type", 1),
];

impl MtlMap {
    /// Parses the text after the keyword; `None` if it has no picture.
    pub fn parse(text: &str) -> Option<Self> {
        let mut map = Self {
            path: String::new(),
            scale: [1.0; 2],
            offset: [0.0; 2],
            is_clamped: false,
            steepness: None,
            others: String::new(),
        };
        let mut words = LineTokens::new(text.as_bytes());
        loop {
            let rest = words.rest();
            let option = words.next()?;
            let is = |name: &str| option.eq_ignore_ascii_case(name.as_bytes());
            if is("-s") || is("-o") {
                let numbers = numbers(&mut words);
                let target = if is("-s") { &mut map.scale } else { &mut map.offset };
                // The third number is for 3D textures.
                target.iter_mut().zip(&numbers).for_each(|(target, number)| *target = *number);
            } else if is("-clamp") {
                map.is_clamped = words.next()? == b"on";
            } else if is("-bm") {
                map.steepness = number(words.next()?).filter(|x| x.is_finite());
            } else if let Some((name, most)) = OTHERS.into_iter().find(|(name, _)| is(name)) {
                map.others += if map.others.is_empty() { "" } else { " " };
                map.others += name;
                let mut add = |word: &[u8]| map.others += &format!(" {}", String::from_utf8_lossy(word));
                if most == 3 {
                    // One to three numbers follow `-t`.
                    numbers(&mut words).iter().for_each(|x| add(format!("{x:?}").as_bytes()));
                } else {
                    words.by_ref().take(most).for_each(&mut add);
                }
            } else {
                let path = String::from_utf8_lossy(rest);
                // Some programs quote names with spaces.
                let bare = path.strip_prefix('"').and_then(|path| path.strip_suffix('"'));
                map.path = bare.unwrap_or(&path).to_owned();
                return (!map.path.is_empty()).then_some(map);
            }
        }
    }
}

/// Up to three numbers; a last word that looks like a number is the picture.
fn numbers(words: &mut LineTokens) -> Vec<f64> {
    let mut parsed = Vec::new();
    while parsed.len() < 3 {
        let mut ahead = words.clone();
        let Some(value) = ahead.next().and_then(number).filter(|x| x.is_finite()) else { break };
        if ahead.rest().is_empty() {
            break;
        }
        parsed.push(value);
        *words = ahead;
    }
    parsed
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn options_stand_before_the_picture() {
        let plain = MtlMap::parse(" a b.png ").unwrap();
        assert_eq!((plain.path.as_str(), plain.scale, plain.offset), ("a b.png", [1.0; 2], [0.0; 2]));
        let map = MtlMap::parse("-s 2 3 1 -o 0.5 -clamp on -bm 0.25 -mm 0 2 -t 1 2 -blendu off 7 of 9.png")
            .unwrap();
        assert_eq!((map.path.as_str(), map.scale, map.offset), ("7 of 9.png", [2.0, 3.0], [0.5, 0.0]));
        assert_eq!((map.is_clamped, map.steepness), (true, Some(0.25)));
        assert_eq!(map.others, "-mm 0 2 -t 1.0 2.0 -blendu off");
        assert_eq!(MtlMap::parse("-s 1 2 3").unwrap().path, "3", "the last word is the picture");
        assert_eq!(MtlMap::parse("\"a b.png\"").unwrap().path, "a b.png");
        for empty in ["", "-clamp on", "-s", "-bm 1", "\"\""] {
            assert_eq!(MtlMap::parse(empty), None, "{empty}");
        }
    }
}
