//! Materials of shapes: colours, and names with metal and roughness.
use super::bind::{BoundArgs, Function, ParameterKind as Kind, SHAPE, optional, required};
use super::{Arg, CallError};
use chordal::implicit::materials::SurfaceMaterial;

const KEPT: &str = "as for the given shape";

/// Functions that give shapes a material.
pub(super) const MATERIALS: &[Function] = &[
    Function {
        name: "color",
        parameters: &[SHAPE, required("color").of(Kind::Color)],
        about: "The shape in a colour: \"#d33\", \"#dd3333\", \"red\", or a list of three or four numbers \
            from 0 to 1, the fourth of which is the opacity. A later colour replaces it.",
        distance: KEPT,
        make: |args| {
            let color = color_at(args, 1)?;
            let [r, g, b, a] = color.map(byte);
            let opacity = if a == u8::MAX { String::new() } else { format!("{a:02x}") };
            paint(args, format!("color-{r:02x}{g:02x}{b:02x}{opacity}"), color, [0.0, 0.5])
        },
    },
    Function {
        name: "material",
        parameters: &[
            SHAPE,
            required("name").of(Kind::Text),
            required("color").of(Kind::Color),
            optional("metallic", 0.0),
            optional("roughness", 0.5),
        ],
        about: "The shape in a material with a name, a colour as for color(), and factors from 0 to 1 for \
            how metallic and how rough it is.",
        distance: KEPT,
        make: |args| {
            let name = args.text(1)?.to_owned();
            let is_plain = (1..=100).contains(&name.len()) && !name.chars().any(char::is_control);
            if !is_plain {
                return Err(args.fault("needs a name of 1 to 100 characters, without control characters"));
            }
            let factors = args.numbers::<2>(3)?;
            for (factor, value) in ["metallic", "roughness"].iter().zip(factors) {
                if !(0.0..=1.0).contains(&value) {
                    return Err(
                        args.fault(&format!("needs a number from 0 to 1 for '{factor}', not {value}"))
                    );
                }
            }
            paint(args, name, color_at(args, 2)?, factors)
        },
    },
];

fn paint(
    args: &BoundArgs,
    name: String,
    color: [f64; 4],
    [metallic, roughness]: [f64; 2],
) -> Result<Arg, CallError> {
    let solid = args.shape(0)?;
    let material = SurfaceMaterial { name, color, metallic, roughness };
    args.shape_result(Ok(solid.field.with_material(material)), &[solid])
}

/// The nearest of 256 levels.
fn byte(x: f64) -> u8 {
    (x * 255.0).round() as u8
}

/// The colour at index `k`: red, green, blue and opacity.
fn color_at(args: &BoundArgs, k: usize) -> Result<[f64; 4], CallError> {
    let wrong = |found: &str| {
        args.fault(&format!(
            "needs a colour like \"#d33\", \"#dd3333\", \"red\" or [0.8, 0.2, 0.2] for 'color', not {found}"
        ))
    };
    match args.any(k) {
        Arg::Text(text) => color_of_text(text).ok_or_else(|| wrong(&format!("\"{text}\""))),
        Arg::List(list) => {
            let numbers: Vec<f64> = list
                .iter()
                .filter_map(|item| if let Arg::Number(x) = item { Some(*x) } else { None })
                .filter(|x| (0.0..=1.0).contains(x))
                .collect();
            match numbers[..] {
                _ if numbers.len() != list.len() => {
                    Err(wrong("a list with values that are not numbers from 0 to 1"))
                }
                [r, g, b] => Ok([r, g, b, 1.0]),
                [r, g, b, a] => Ok([r, g, b, a]),
                _ => Err(wrong(&format!("a list of {} numbers", numbers.len()))),
            }
        }
        other => Err(wrong(other.kind())),
    }
}

/// A colour by its name or by its hexadecimal digits after `#`: 3 or 6, or 4 or 8 with an opacity.
fn color_of_text(text: &str) -> Option<[f64; 4]> {
    if let Some((_, rgb)) = NAMED.iter().find(|(name, _)| name.eq_ignore_ascii_case(text)) {
        let [_, r, g, b] = rgb.to_be_bytes();
        return Some([r, g, b, u8::MAX].map(|x| f64::from(x) / 255.0));
    }
    let digits: Vec<u32> = text.strip_prefix('#')?.chars().map(|c| c.to_digit(16)).collect::<Option<_>>()?;
    let level = |k: usize| match digits.len() {
        // #abc stands for #aabbcc, and 16·a + a = 17·a.
        3 | 4 => digits.get(k).map(|digit| 17 * digit),
        _ => digits.get(2 * k).zip(digits.get(2 * k + 1)).map(|(high, low)| 16 * high + low),
    };
    if !matches!(digits.len(), 3 | 4 | 6 | 8) {
        return None;
    }
    Some([0, 1, 2, 3].map(|k| level(k).map_or(1.0, |x| f64::from(x) / 255.0)))
}

/// Names of colours. Source: the basic names of *CSS Color Module Level 4*, W3C, and orange.
const NAMED: [(&str, u32); 17] = [
    ("black", 0x00_0000),
    ("silver", 0xc0_c0c0),
    ("gray", 0x80_8080),
    ("white", 0xff_ffff),
    ("maroon", 0x80_0000),
    ("red", 0xff_0000),
    ("purple", 0x80_0080),
    ("fuchsia", 0xff_00ff),
    ("green", 0x00_8000),
    ("lime", 0x00_ff00),
    ("olive", 0x80_8000),
    ("yellow", 0xff_ff00),
    ("navy", 0x00_0080),
    ("blue", 0x00_00ff),
    ("teal", 0x00_8080),
    ("aqua", 0x00_ffff),
    ("orange", 0xff_a500),
];
