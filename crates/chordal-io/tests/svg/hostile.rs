//! Bad drawings: row 77 of the list of what a file may try, and what XML can be abused for.
use super::{count, load, svg};
use crate::common::refuse;
use chordal_io::{FileLocation, Format, Limits, ReadError, read};

#[track_caller]
fn fail(text: &str) -> ReadError {
    refuse(text.as_bytes(), Format::Svg)
}

#[test]
fn h77_use_in_a_circle_is_refused_with_its_place() {
    for (body, at) in [
        ("\n<g id='a'><use href='#a'/></g>", "line 2, column 22"),
        ("\n<use id='a' href='#a'/>", "line 2, column 19"),
        ("\n<g id='a'><use href='#b'/></g><g id='b'><use href='#a'/></g>", ""),
        (
            "<symbol id='a'><use href='#b'/></symbol><symbol id='b'><use href='#a'/></symbol><use href='#a'/>",
            "",
        ),
    ] {
        let error = fail(&svg(body));
        assert_eq!(error.code, "use-cycle", "{body}");
        assert!(error.place.to_string().contains(at), "{body}: {error}");
    }
}

#[test]
fn h77_uses_of_uses_are_counted_and_not_written_out() {
    let mut body = "<defs><path id='u0' d='M0 0h1v1z'/>".to_owned();
    for level in 1..=10 {
        let uses = format!("<use href='#u{}'/>", level - 1).repeat(10);
        body += &format!("<g id='u{level}'>{uses}</g>");
    }
    let error = fail(&svg(&(body + "</defs><use href='#u10'/>")));
    assert_eq!(error.code, "too-many-copies");
    assert!(error.to_string().contains("limit of 20"), "{error}");
    // A thousand copies of one shape are fine.
    let many = "<use href='#a'/>".repeat(1000);
    let (drawing, _) = load(&svg(&format!("<path id='a' d='M0 0h1v1z'/>{many}")));
    assert_eq!(drawing.lines.len(), 1001);
}

#[test]
fn h77_deep_nesting_is_refused_and_long_chains_of_use_too() {
    let deep = |n: usize| svg(&format!("{}<path d='M0 0h1'/>{}", "<g>".repeat(n), "</g>".repeat(n)));
    assert_eq!(load(&deep(100)).0.lines.len(), 1);
    let error = fail(&deep(200_000));
    assert_eq!(error.code, "too-deep");
    assert!(error.to_string().contains("limit of 128"), "{error}");
    let mut chain = "<defs><path id='u0' d='M0 0h1'/>".to_owned();
    for i in 1..2000 {
        chain += &format!("<g id='u{i}'><use href='#u{}'/></g>", i - 1);
    }
    assert_eq!(fail(&svg(&(chain + "</defs><use href='#u1999'/>"))).code, "too-deep");
}

#[test]
fn h77_contours_of_one_point_draw_nothing_and_are_counted() {
    let (drawing, warnings) = load(&svg(&format!("<path d='{}M0 0h1'/>", "M1 1".repeat(1000))));
    assert_eq!((drawing.lines.len(), count(&warnings, "lone-point")), (1, 1000));
}

#[test]
fn h77_numbers_that_are_not_finite_are_refused_with_their_place() {
    for (body, token) in [
        ("<path d='M0 0L1e999 0'/>", "1e999"),
        ("<path d='M0 0L NaN 0'/>", "NaN"),
        ("<path d='M0 0L1 -inf'/>", "-inf"),
        ("<path d='M1e308 0l1e308 0'/>", "1e308 0'"),
        ("<path d='M0 0a1e-200 1 0 0 1 1 1'/>", "1e-200"),
        ("<circle r='1e999'/>", "1e999"),
        ("<circle r='nan'/>", "nan"),
        ("<rect x='1e308' width='1e308' height='1'/>", "<rect"),
        ("<polygon points='0 0 1 1e999'/>", "1e999"),
        ("<g transform='scale(1e999)'/>", "1e999"),
        ("<g transform='scale(1e200) scale(1e200)'><path d='M1 0h1'/></g>", "<path"),
        ("<svg viewBox='0 0 1e999 1'/>", "1e999"),
    ] {
        let error = fail(&svg(&format!("\n   {body}")));
        assert_eq!(error.code, "not-finite", "{body}: {error}");
        let column = 4 + body.find(token).unwrap();
        assert_eq!(error.place.to_string(), format!("line 2, column {column}"), "{body}: {error}");
    }
}

#[test]
fn h50_document_types_with_declarations_are_refused_and_others_ignored() {
    let bomb = "<!DOCTYPE svg [<!ENTITY a \"aaaaaaaaaa\"><!ENTITY b \"&a;&a;&a;&a;&a;&a;&a;&a;\">]><svg><path d='&b;'/></svg>";
    let error = fail(bomb);
    assert_eq!(error.code, "dtd-not-allowed");
    assert!(error.to_string().contains("DTD not allowed"), "{error}");
    let external = "<!DOCTYPE svg [<!ENTITY x SYSTEM \"file:///etc/passwd\">]><svg>&x;</svg>";
    assert_eq!(fail(external).code, "dtd-not-allowed");
    let usual = "<!DOCTYPE svg PUBLIC \"-//W3C//DTD SVG 1.1//EN\" \"http://www.w3.org/Graphics/SVG/1.1/DTD/svg11.dtd\">\n";
    let (drawing, warnings) = load(&(usual.to_owned() + &svg("<path d='M0 0h1'/>")));
    assert_eq!((drawing.lines.len(), count(&warnings, "ignored-doctype")), (1, 1));
    for body in ["<path d='M0 0&x;'/>", "<style>&x;</style>", "<g>&x;</g>"] {
        assert_eq!(fail(&svg(body)).code, "unknown-entity", "{body}");
    }
    // Those of XML itself are known.
    assert_eq!(load(&svg("<path d='M0&#x20;0&#10;h1'/>")).0.lines.len(), 1);
}

#[test]
fn h50_a_million_attributes_or_namespaces_are_refused_or_linear() {
    let attributes: String = (0..100_000).map(|i| format!(" a{i}=''")).collect();
    assert_eq!(fail(&svg(&format!("<g{attributes}/>"))).code, "too-many-attributes");
    let spaces: String = (0..100).map(|i| format!(" xmlns:n{i}='urn:{i}'")).collect();
    let many = format!("<g{spaces}/>").repeat(300);
    assert!(load(&svg(&many)).0.lines.is_empty());
}

#[test]
fn what_is_no_well_formed_xml_is_refused_with_its_place() {
    for (text, code) in [
        ("<svg><path d='M0 0h1'/>", "not-xml"),
        ("<svg><g></svg>", "not-xml"),
        ("<svg></svg><svg/>", "not-xml"),
        ("<svg/>text", "not-xml"),
        ("<svg><path d=M0/></svg>", "not-xml"),
        ("<svg><path d='1' d='2'/></svg>", "not-xml"),
        ("<svg><path d='M0 0", "not-xml"),
        ("</svg>", "not-xml"),
        ("<html/>", "not-svg"),
        ("<svg xmlns='urn:other'/>", "not-svg"),
        ("<!-- only -->", "not-svg"),
        ("<?xml version='1.0' encoding='ISO-8859-1'?><svg><g id='\u{e9}'/></svg>", "not-utf8"),
        ("hello", "not-xml"),
        ("<svg>\0</svg>", "not-text"),
    ] {
        let error = fail(text);
        assert_eq!(error.code, code, "{text}: {error}");
    }
    assert_eq!(refuse(b"<svg>\xff</svg>", Format::Svg).place, FileLocation::Byte(5));
    assert_eq!(refuse(b"\xff\xfe<\0s\0", Format::Svg).code, "not-utf8");
    assert_eq!(refuse(b" \n", Format::Svg).code, "empty");
}

#[test]
fn h77_styles_stay_linear() {
    let rules: String = (0..20_000).map(|_| ".a{fill:red}").collect();
    let shapes = "<path class='a' d='M0 0h1'/>".repeat(200);
    let (drawing, warnings) = load(&svg(&format!("<style>{rules}</style>{shapes}")));
    assert_eq!((drawing.lines.len(), count(&warnings, "too-many-css-rules")), (200, 20_000 - 4096));
}

#[test]
fn limits_hold() {
    let limits = Limits { rows: 10, ..Limits::default() };
    let many = svg(&"<g/>".repeat(20));
    assert_eq!(read(many.as_bytes(), Format::Svg, &limits).unwrap_err().code, "too-many-rows");
    let limits = Limits { bytes: 10, ..Limits::default() };
    assert_eq!(read(many.as_bytes(), Format::Svg, &limits).unwrap_err().code, "too-large");
}

#[test]
fn h77_millions_of_segments_in_one_path_load() {
    let (drawing, _) = load(&svg(&format!("<path d='M0 0{}'/>", "l1 1-1 2".repeat(1_000_000))));
    assert_eq!(drawing.lines[0].segments().len(), 2_000_000);
}
