//! A font of six glyphs, built here so that tests of letters need no foreign file.
//!
//! Its em has 1,000 units. Glyphs, with their characters and advances: 0 (none), 1 (space, 300), 2 (`A`, 600,
//! a rectangle of 500 × 700), 3 (`O`, 700, a ring of quadratic curves), 4 (`X`, 600, two bars that overlap),
//! 5 (`V`, 600, a triangle). The pairs of `A` and `V` are kerned by −150. On the axis `wght`, from 400 to
//! 900, `A` and its advance get 100 wider.

/// A glyph: its contours, each point with whether it is on the curve, its advance.
struct TinyGlyph {
    contours: Vec<Vec<(i16, i16, bool)>>,
    advance: u16,
}

/// The area of a glyph of the [`tiny_font`] in square units, by its character, at the default of the axis.
///
/// # Panics
/// If the font lacks the character.
#[must_use]
pub fn tiny_glyph_area(character: char) -> f64 {
    match character {
        ' ' => 0.0,
        'A' => 500.0 * 700.0,
        // A parabola cuts a third off the triangle of its control points: of four corners with sides of 300,
        // and of the hole's with sides of 150.
        'O' => (600.0 * 600.0 - 4.0 * 300.0 * 300.0 / 6.0) - (300.0 * 300.0 - 4.0 * 150.0 * 150.0 / 6.0),
        // Two bars of 600 × 100, which share a square.
        'X' => 2.0 * 600.0 * 100.0 - 100.0 * 100.0,
        'V' => 500.0 * 700.0 / 2.0,
        other => panic!("the font has no {other}"),
    }
}

/// The bytes of the font.
#[must_use]
pub fn tiny_font() -> Vec<u8> {
    let glyphs = glyphs();
    let mut loca = vec![0_u32];
    let mut glyf = Vec::new();
    for glyph in &glyphs {
        glyf.extend(outline(glyph));
        loca.push(glyf.len() as u32);
    }
    let n_glyphs = glyphs.len() as u16;
    let hmtx = glyphs.iter().flat_map(|glyph| [glyph.advance.to_be_bytes(), [0; 2]]).flatten().collect();
    let loca = loca.into_iter().flat_map(u32::to_be_bytes).collect();
    font_of(vec![
        (*b"cmap", cmap()),
        (*b"fvar", fvar()),
        (*b"glyf", glyf),
        (*b"gvar", gvar(n_glyphs)),
        (*b"head", head()),
        (*b"hhea", words(&[1, 0, 800, -200_i16 as u16, 100, 700, 0, 0, 0, 1, 0, 0, 0, 0, 0, 0, 0, n_glyphs])),
        (*b"hmtx", hmtx),
        (*b"kern", words(&[0, 1, 0, 26, 1, 2, 12, 1, 0, 2, 5, -150_i16 as u16, 5, 2, -150_i16 as u16])),
        (*b"loca", loca),
        (*b"maxp", words(&[1, 0, n_glyphs, 16, 4, 0, 0, 1, 0, 0, 0, 0, 0, 0, 0, 0])),
    ])
}

fn words(words: &[u16]) -> Vec<u8> {
    words.iter().flat_map(|word| word.to_be_bytes()).collect()
}

fn glyphs() -> Vec<TinyGlyph> {
    // Clockwise, as TrueType's outer contours.
    let corners = |points: &[(i16, i16)]| points.iter().map(|(x, y)| (*x, *y, true)).collect::<Vec<_>>();
    let bar = |x: i16, y: i16, w: i16, h: i16| corners(&[(x, y), (x, y + h), (x + w, y + h), (x + w, y)]);
    let round = |low: i16, high: i16| {
        [(low, low), (low, high), (high, high), (high, low)].map(|(x, y)| (x, y, false))
    };
    let mut hole = round(150, 450).to_vec();
    hole.reverse();
    let glyph = |contours, advance| TinyGlyph { contours, advance };
    vec![
        glyph(vec![], 500),
        glyph(vec![], 300),
        glyph(vec![bar(0, 0, 500, 700)], 600),
        glyph(vec![round(0, 600).to_vec(), hole], 700),
        glyph(vec![bar(0, 250, 600, 100), bar(250, 0, 100, 600)], 600),
        glyph(vec![corners(&[(0, 700), (500, 700), (250, 0)])], 600),
    ]
}

/// A simple glyph of `glyf`; empty without contours.
fn outline(glyph: &TinyGlyph) -> Vec<u8> {
    let points: Vec<_> = glyph.contours.iter().flatten().collect();
    if points.is_empty() {
        return Vec::new();
    }
    let range = |coordinate: fn(&(i16, i16, bool)) -> i16| {
        let values = points.iter().map(|point| coordinate(point));
        (values.clone().min().expect("a point"), values.max().expect("a point"))
    };
    let ((left, right), (low, high)) = (range(|p| p.0), range(|p| p.1));
    let mut bytes = words(&[glyph.contours.len() as u16]);
    bytes.extend(words(&[left, low, right, high].map(|x| x as u16)));
    let mut end = 0;
    for contour in &glyph.contours {
        end += contour.len() as u16;
        bytes.extend(words(&[end - 1]));
    }
    // No instructions; then a flag for each point, and the differences between points, each as a word.
    bytes.extend(words(&[0]));
    bytes.extend(points.iter().map(|point| u8::from(point.2)));
    for coordinate in [|p: &(i16, i16, bool)| p.0, |p: &(i16, i16, bool)| p.1] {
        let mut before = 0;
        for point in &points {
            bytes.extend((coordinate(point) - before).to_be_bytes());
            before = coordinate(point);
        }
    }
    bytes.resize(bytes.len().next_multiple_of(4), 0);
    bytes
}

fn head() -> Vec<u8> {
    // Version, revision, checksum, magic, flags, units; two dates; the box; style, smallest size, direction;
    // offsets as 32 bits, and the only format of glyph data.
    let mut head = words(&[1, 0, 1, 0, 0, 0, 0x5F0F, 0x3CF5, 3, 1000]);
    head.extend([0; 16]);
    head.extend(words(&[0, 0, 700, 700, 0, 8, 2, 1, 0]));
    head
}

/// Groups of one character each (format 12).
fn cmap() -> Vec<u8> {
    let mut groups: Vec<_> = " AOXV".chars().zip(1_u32..).collect();
    groups.sort_unstable();
    let mut cmap = words(&[0, 1, 3, 10, 0, 12, 12, 0]);
    let len = 16 + 12 * groups.len() as u32;
    cmap.extend([len, 0, groups.len() as u32].into_iter().flat_map(u32::to_be_bytes));
    let groups = groups.into_iter().flat_map(|(c, glyph)| [u32::from(c), u32::from(c), glyph]);
    cmap.extend(groups.flat_map(u32::to_be_bytes));
    cmap
}

fn fvar() -> Vec<u8> {
    let mut fvar = words(&[1, 0, 16, 2, 1, 20, 0, 8]);
    fvar.extend(b"wght");
    fvar.extend(words(&[400, 0, 400, 0, 900, 0, 0, 256]));
    fvar
}

/// One variation of glyph 2 at the end of the axis: deltas of its four points and of the four phantom points
/// of its metrics.
fn gvar(n_glyphs: u16) -> Vec<u8> {
    let mut varied = words(&[1, 10, 11, 0xA000, 0x4000]);
    varied.extend([0, 7, 0, 0, 100, 100, 0, 100, 0, 0, 0x87]);
    varied.resize(varied.len().next_multiple_of(4), 0);
    let offsets = 20 + 4 * (u32::from(n_glyphs) + 1);
    let mut gvar = words(&[1, 0, 1, 0]);
    gvar.extend(offsets.to_be_bytes());
    gvar.extend(words(&[n_glyphs, 1]));
    gvar.extend(offsets.to_be_bytes());
    let ends = (0..=u32::from(n_glyphs)).map(|glyph| if glyph > 2 { varied.len() as u32 } else { 0 });
    gvar.extend(ends.flat_map(u32::to_be_bytes));
    gvar.extend(varied);
    gvar
}

/// The file: the table directory, and the tables.
fn font_of(tables: Vec<([u8; 4], Vec<u8>)>) -> Vec<u8> {
    let n = tables.len() as u16;
    let mut file = words(&[1, 0, n, 128, 3, n * 16 - 128]);
    let mut offset = file.len() + 16 * tables.len();
    let mut content = Vec::new();
    for (tag, table) in tables {
        file.extend(tag);
        // The checksum of a table is 0, since readers ignore it.
        file.extend([0, offset as u32, table.len() as u32].into_iter().flat_map(u32::to_be_bytes));
        content.extend(&table);
        content.resize(content.len().next_multiple_of(4), 0);
        offset += table.len().next_multiple_of(4);
    }
    file.extend(content);
    file
}
