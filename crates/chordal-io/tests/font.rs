//! Letters of fonts: areas and places in closed form, pairs and axes, and what is refused.
use chordal::explicit::{Curve, CurveSegment, FillRule};
use chordal_io::font::{Letters, fonts_in, letters_in, read_letters};
use chordal_io::{Content, Drawing, ForeignFormat, Format, Limits, read};
use chordal_testkit::{Random, cases, corpus, tiny_font, tiny_glyph_area};

fn set(letters: &Letters) -> Drawing {
    let read =
        read_letters(&tiny_font(), letters, &Limits::default()).unwrap_or_else(|error| panic!("{error}"));
    let Content::Drawing(drawing) = read.content else { panic!("letters are a drawing") };
    drawing
}

fn refusal(bytes: &[u8], letters: &Letters, limits: &Limits) -> (&'static str, String) {
    let error = read_letters(bytes, letters, limits).map(|_| ()).expect_err("refused");
    let message = error.to_string();
    assert!(!message.contains('\n') && !message.ends_with('.'), "one sentence: {message}");
    (error.code, message)
}

/// The area on the left of a closed curve by Green's theorem, exact for lines and cubics.
fn signed_area(curve: &Curve<2>) -> f64 {
    let cross = |[a, b]: [f64; 2], [c, d]: [f64; 2]| a * d - b * c;
    let pieces = curve.segments().iter().map(|piece| match piece {
        CurveSegment::Line([a, b]) => cross(*a, *b) / 2.0,
        CurveSegment::Cubic(cubic) => {
            // The integral of a product of two Bernstein polynomials with a derivative, summed by hand.
            let [a, b, c, d] = cubic.control;
            (6.0 * cross(a, b)
                + 3.0 * cross(a, c)
                + cross(a, d)
                + 3.0 * cross(b, c)
                + 3.0 * cross(b, d)
                + 6.0 * cross(c, d))
                / 20.0
        }
        CurveSegment::Arc(_) | CurveSegment::Rational(_) => panic!("fonts have neither"),
    });
    pieces.sum()
}

fn extent(drawing: &Drawing) -> [[f64; 2]; 2] {
    let boxes = drawing.lines.iter().map(Curve::bounds);
    boxes
        .reduce(|[a, b], [c, d]| [[a[0].min(c[0]), a[1].min(c[1])], [b[0].max(d[0]), b[1].max(d[1])]])
        .unwrap()
}

#[test]
fn glyphs_have_their_area_at_any_size() {
    for size in [1e-3, 1.0, 12.5, 1e6] {
        for (text, n_contours) in [("A", 1), ("O", 2), ("V", 1)] {
            let drawing = set(&Letters { em: size, ..Letters::new(text) });
            assert_eq!(drawing.lines.len(), n_contours);
            assert!(drawing.lines.iter().all(Curve::is_closed) && !drawing.y_down);
            // Contours of TrueType have the filled side on their right.
            let area: f64 = -drawing.lines.iter().map(signed_area).sum::<f64>();
            let truth = tiny_glyph_area(text.chars().next().unwrap()) * (size / 1000.0) * (size / 1000.0);
            assert!((area / truth - 1.0).abs() < 1e-12, "{text} at {size}: {area}, not {truth}");
        }
    }
}

#[test]
fn a_text_is_one_element_that_is_filled_where_contours_wind() {
    let drawing = set(&Letters::new("AX O"));
    let [element] = &drawing.elements[..] else { panic!("one element") };
    assert_eq!(
        (element.kind, &*element.name, element.rule, element.filled),
        ("text", "AX O", FillRule::NonZero, true)
    );
    assert_eq!((drawing.lines.len(), drawing.owners.len()), (5, 5));
}

#[test]
fn letters_stand_where_advances_pairs_and_lines_put_them() {
    let right = |letters: &Letters| extent(&set(letters))[1][0];
    // The advance of A, and the width of the second letter.
    assert_eq!(right(&Letters::new("AA")), (600.0 + 500.0) / 1000.0);
    assert_eq!(right(&Letters::new("A A")), (600.0 + 300.0 + 500.0) / 1000.0);
    // The pair of the table.
    assert_eq!(right(&Letters::new("AV")), (600.0 - 150.0 + 500.0) / 1000.0);
    // From line to line: 800 up, 200 down, 100 between; the capital is 700 high.
    let [[_, low], [_, high]] = extent(&set(&Letters { em: 10.0, ..Letters::new("A\nA\r\n\nA") }));
    assert_eq!((low, high), (-33.0, 7.0));
}

#[test]
fn lines_are_aligned_by_their_advances() {
    let ends = |text: &str, align: f64| {
        let [[left, _], [right, _]] = extent(&set(&Letters { align, ..Letters::new(text) }));
        [left, right]
    };
    // A letter is 500 wide and its advance 600; that of a space is 300, at the end of a line too.
    for (text, advance) in [("A", 0.6), ("AA", 1.2), ("A ", 0.9), ("AV", 1.05)] {
        let [left, right] = ends(text, 0.0);
        for align in [0.5, 1.0] {
            let found = ends(text, align);
            for (found, start) in found.into_iter().zip([left, right]) {
                assert!((found - (start - align * advance)).abs() < 1e-15, "{text} by {align}: {found}");
            }
        }
    }
    // Each line by itself: the box is that of the longer one.
    assert_eq!(ends("AA\nA", 0.5), [-0.6, 0.5]);
    assert_eq!(ends("AA\nA", 1.0), [-1.2, -0.1]);
}

#[test]
fn axes_move_points_and_advances() {
    let at = |wght: f64, text: &str| {
        extent(&set(&Letters { axes: vec![("wght".to_owned(), wght)], ..Letters::new(text) }))[1][0]
    };
    assert_eq!(at(400.0, "A"), 0.5);
    assert_eq!(at(900.0, "A"), 0.6);
    assert_eq!(at(650.0, "A"), 0.55);
    // Both letters, and the advance of the first.
    assert_eq!(at(900.0, "AA"), 1.3);
}

#[test]
fn slack_counts_the_rounding_of_places() {
    // A tenth of a unit of the font has no end in binary.
    let drawing = set(&Letters { em: 0.1, ..Letters::new("O") });
    for curve in &drawing.lines {
        let slack = curve.slack();
        assert!(slack > 0.0 && slack < 1e-15, "{slack}");
    }
}

#[test]
fn what_no_font_can_set_is_refused_in_a_sentence() {
    let font = tiny_font();
    let refused = |letters: &Letters| refusal(&font, letters, &Limits::default());
    let axis = |name: &str, value: f64| Letters { axes: vec![(name.to_owned(), value)], ..Letters::new("A") };
    for (letters, code, part) in [
        (Letters::new(""), "no-text", "blank"),
        (Letters::new(" \n "), "no-text", "blank"),
        (Letters::new(&"A".repeat(1_000_000)), "too-large", "10,000 characters"),
        (Letters::new("A文"), "no-glyph", "'文' (U+6587)"),
        (Letters::new("A\tA"), "no-glyph", "U+0009"),
        (axis("wdth", 100.0), "no-axis", "wght"),
        (axis("weight", 500.0), "no-axis", "'weight'"),
        (axis("wght", 100.0), "axis-range", "from 400 to 900"),
        (axis("wght", f64::NAN), "axis-range", "from 400 to 900"),
        (Letters { em: 0.0, ..Letters::new("A") }, "em", "not 0"),
        (Letters { em: f64::NAN, ..Letters::new("A") }, "em", "NaN"),
        (Letters { em: -1.0, ..Letters::new("A") }, "em", "-1"),
        (Letters::new("AאV"), "two-directions", "right to left"),
        (Letters::new("א1"), "two-directions", "right to left"),
    ] {
        let (found, message) = refused(&letters);
        assert!(found == code && message.contains(part), "{found}: {message}");
    }
    let longest = Letters::new(&"A".repeat(10_000));
    assert_eq!(set(&longest).lines.len(), 10_000);
}

#[test]
fn a_font_alone_has_no_shape_and_is_known_by_its_content() {
    let font = tiny_font();
    assert_eq!(Format::sniff(&font), Some(Format::Ttf));
    assert_eq!(Format::from_extension("OTF"), Some(Format::Ttf));
    let error = read(&font, Format::Ttf, &Limits::default()).unwrap_err();
    assert_eq!(error.code, "no-text");
    let woff = ForeignFormat::sniff(b"wOF2\0\x01\0\0").unwrap();
    assert!(woff.name.contains("WOFF2") && woff.way.contains("fonttools"));
}

/// A collection of the same font several times.
fn collection(n: u32) -> Vec<u8> {
    let font = tiny_font();
    let start = 12 + 4 * n;
    let mut file = [&b"ttcf\0\x01\0\0"[..], &n.to_be_bytes()].concat();
    (0..n).for_each(|_| file.extend(start.to_be_bytes()));
    let at = file.len();
    file.extend(&font);
    // Tables are where they are in the file.
    let n_tables = usize::from(font[5]);
    for row in 0..n_tables {
        let offset = at + 12 + 16 * row + 8;
        let table = u32::from_be_bytes(file[offset..offset + 4].try_into().unwrap()) + start;
        file[offset..offset + 4].copy_from_slice(&table.to_be_bytes());
    }
    file
}

#[test]
fn a_collection_is_asked_for_one_of_its_fonts() {
    let file = collection(3);
    assert_eq!(Format::sniff(&file), Some(Format::Ttf));
    let letters = Letters::new("A");
    let at = |index| Limits { index, ..Limits::default() };
    assert!(read_letters(&file, &letters, &at(Some(2))).is_ok());
    assert_eq!(refusal(&file, &letters, &at(None)).0, "several-fonts");
    assert_eq!(refusal(&file, &letters, &at(Some(3))).0, "no-such-font");
    assert_eq!(refusal(&tiny_font(), &letters, &at(Some(1))).0, "no-such-font");
}

#[test]
fn broken_tables_are_refused_or_read_and_never_more() {
    let font = tiny_font();
    let letters = Letters { axes: vec![("wght".to_owned(), 700.0)], ..Letters::new("AOXV\nAV") };
    let limits = Limits::default();
    for end in 0..font.len() {
        if let Err(error) = read_letters(&font[..end], &letters, &limits) {
            assert!(!error.code.is_empty() && !error.message.is_empty());
        }
    }
    assert_eq!(refusal(&font[..100], &letters, &limits).0, "no-font");
    let seed = 5;
    println!("seed {seed}");
    let mut random = Random::new(seed);
    let (mut read, mut refused) = (0, 0);
    for at in 0..font.len() {
        for _ in 0..cases(8) {
            let mut broken = font.clone();
            broken[at] ^= 1 << (random.below(8));
            match read_letters(&broken, &letters, &limits) {
                Ok(_) => read += 1,
                Err(error) => {
                    assert!(!error.code.is_empty() && !error.message.is_empty());
                    refused += 1;
                }
            }
        }
    }
    assert!(read > 100 && refused > 100, "{read} {refused}");
}

#[test]
fn fonts_of_others_end_well_however_they_are_broken() {
    let Some(folder) = corpus::find("outline/vello/examples/assets") else { return };
    let fonts: Vec<_> = corpus::files(&folder)
        .into_iter()
        .filter(|file| file.extension().is_some_and(|e| e == "ttf"))
        .collect();
    assert!(!fonts.is_empty(), "there are fonts");
    let seed = 6;
    println!("seed {seed}");
    let mut random = Random::new(seed);
    for file in fonts {
        let font = std::fs::read(&file).unwrap();
        let letters = Letters::new("AVATAR fi ß é q0@");
        read_letters(&font, &letters, &Limits::default())
            .unwrap_or_else(|error| panic!("{}: {error}", file.display()));
        for _ in 0..cases(200) {
            let mut broken = font.clone();
            for _ in 0..8 {
                // Half of the changes are in the list of tables and the first of them.
                let within = if random.below(2) == 0 { 2000 } else { broken.len() };
                let at = random.below(within);
                broken[at] = random.bits() as u8;
            }
            let _ = read_letters(&broken, &letters, &Limits::default());
        }
    }
}

#[test]
fn the_fonts_of_a_file_are_listed_by_name_glyphs_and_axes() {
    let listed = fonts_in(&tiny_font(), &Limits::default()).unwrap();
    assert_eq!(listed, ["a font without a name, 6 glyphs, wght 400 to 900"]);
    assert_eq!(fonts_in(b"not a font", &Limits::default()).unwrap_err().code, "no-font");
    // It lacks the letters of any name, and has these.
    assert_eq!(letters_in(&tiny_font(), &Limits::default()).unwrap(), "AOVX");
}
