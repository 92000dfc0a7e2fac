//! What surrounds shapes: transforms, view boxes, `use`, styles, and what is not supported.
use super::{count, inside, load, near, svg};
use chordal::explicit::FillRule;
use chordal_io::Limits;

#[test]
fn transforms_add_up_from_the_outside_in() {
    let drawing = inside(
        "<g transform='translate(10 20)'><g transform='scale(2)'><path transform='rotate(90)' d='M1 0h1'/></g></g>",
    );
    assert_eq!((drawing.lines[0].start(), drawing.lines[0].end()), ([10.0, 22.0], [10.0, 24.0]));
    let slack = drawing.lines[0].slack();
    assert!(slack > 0.0 && slack < 1e-12, "rounding is counted: {slack}");
    let (drawing, warnings) =
        load(&svg("<path transform='spin(3)' d='M1 0h1'/><path transform='scale(0)' d='M1 0h1'/>"));
    assert_eq!((drawing.lines.len(), drawing.lines[0].start()), (1, [1.0, 0.0]));
    assert_eq!((count(&warnings, "bad-transform"), count(&warnings, "singular-transform")), (1, 1));
}

#[test]
fn coordinates_are_those_of_the_view_box_and_sizes_give_the_unit() {
    let root = |attributes: &str| {
        let text = format!("<svg xmlns='http://www.w3.org/2000/svg' {attributes}><path d='M1 2h3'/></svg>");
        let (drawing, _) = load(&text);
        assert_eq!(drawing.lines[0].start(), [1.0, 2.0], "{attributes}");
        (drawing.view_box, drawing.frame.metres_per_unit)
    };
    let view = Some([0.0, 0.0, 200.0, 100.0]);
    assert_eq!(root("viewBox='0 0 200 100' width='100mm' height='50mm'"), (view, Some(0.0005)));
    assert_eq!(root("viewBox='0 0 200 100' width='2cm'"), (view, Some(0.0001)));
    assert_eq!(root("viewBox='0 0 200 100' width='400' height='200'"), (view, None));
    assert_eq!(root("viewBox='0 0 200 100' width='100mm' height='100mm'"), (view, Some(0.0005)));
    let stretched = "viewBox='0 0 200 100' width='100mm' height='100mm' preserveAspectRatio='none'";
    assert_eq!(root(stretched), (view, None));
    assert_eq!(root("width='96' height='48'"), (Some([0.0, 0.0, 96.0, 48.0]), None));
    assert_eq!(root("viewBox='0 0 0 1'"), (None, None));
    let (view_box, metres) = root("width='1in' height='1in'");
    assert_eq!(view_box, Some([0.0, 0.0, 96.0, 96.0]));
    assert!((metres.unwrap() - 0.0254 / 96.0).abs() < 1e-18);
}

#[test]
fn inner_pictures_have_their_own_view_boxes() {
    let (drawing, warnings) = load(&svg(
        "<svg x='10' y='20' width='100' height='50' viewBox='0 0 10 10'><path d='M0 0L10 10'/></svg>\
         <svg x='5' width='40' height='40'><rect width='50%' height='25%'/></svg>",
    ));
    // Everything shown, in the middle: scaled by 5, with 25 left on both sides.
    near(drawing.lines[0].start(), [35.0, 20.0]);
    near(drawing.lines[0].end(), [85.0, 70.0]);
    near(drawing.lines[1].at(2.0), [25.0, 10.0]);
    assert_eq!(count(&warnings, "unsupported-viewport-clip"), 2);
}

#[test]
fn use_draws_its_target_where_it_says() {
    let drawing = inside(
        "<defs><path id='a' d='M0 0h1'/></defs><use href='#a' x='5' y='6'/>\
         <use xlink:href='#a' transform='scale(2)' x='1'/><g id='g'><use href='#a'/></g><use href='#g' y='3'/>",
    );
    let starts: Vec<_> = drawing.lines.iter().map(|curve| curve.start()).collect();
    assert_eq!(starts, [[5.0, 6.0], [2.0, 0.0], [0.0, 0.0], [0.0, 3.0]]);
    assert_eq!(drawing.lines[1].end(), [4.0, 0.0]);
    assert!(drawing.elements.iter().all(|element| &*element.name == "a"));
}

#[test]
fn symbols_are_drawn_through_use_alone() {
    let (drawing, _) = load(&svg("<symbol id='s' viewBox='0 0 10 10'><path d='M0 0L10 10'/></symbol>\
         <use href='#s' x='1' y='2' width='20' height='20'/><use href='#s' width='5' height='5'/>"));
    assert_eq!(drawing.lines.len(), 2);
    near(drawing.lines[0].start(), [1.0, 2.0]);
    near(drawing.lines[0].end(), [21.0, 22.0]);
    near(drawing.lines[1].end(), [5.0, 5.0]);
}

#[test]
fn targets_that_are_not_there_are_counted_and_nothing_is_fetched() {
    let (drawing, warnings) = load(&svg(
        "<use href='#nobody'/><use href='other.svg#a'/><use/><use href='https://x.y/z.svg#a'/><path d='M0 0h1'/>",
    ));
    assert_eq!(drawing.lines.len(), 1);
    assert_eq!((count(&warnings, "missing-target"), count(&warnings, "external-use")), (2, 2));
}

#[test]
fn fill_and_fill_rule_are_inherited_and_overridden() {
    let body = "<style>.x { fill: none; fill-rule: evenodd } #last { fill: red }</style>\
        <g fill='none' fill-rule='evenodd'><path d='M0 0h1v1z'/><path d='M0 0h1v1z' fill='red' fill-rule='nonzero'/>\
        <path d='M0 0h1v1z' style='fill: #fff'/></g><path class='a x' d='M0 0h1v1z'/>\
        <path class='x' style='fill:blue' d='M0 0h1v1z'/><path id='last' class='x' d='M0 0h1v1z'/>\
        <g fill='none'><path fill='inherit' d='M0 0h1v1z'/></g>";
    let all: Vec<_> = inside(body).elements.iter().map(|e| (e.filled, e.rule)).collect();
    let (even, non) = (FillRule::EvenOdd, FillRule::NonZero);
    let expected =
        [(false, even), (true, non), (true, even), (false, even), (true, even), (true, even), (false, non)];
    assert_eq!(all, expected);
}

#[test]
fn what_is_not_displayed_is_counted() {
    let body = "<g display='none'><path d='M0 0h1'/></g><path visibility='hidden' d='M0 0h1'/>\
        <g visibility='hidden'><path visibility='visible' d='M0 0h1'/></g><path style='display: none' d='M0 0h1'/>\
        <style>.h{display:none}</style><path class='h' d='M0 0h1'/>";
    let (drawing, warnings) = load(&svg(body));
    assert_eq!((drawing.lines.len(), count(&warnings, "hidden")), (1, 4));
}

#[test]
fn what_is_not_supported_is_listed_never_silently_skipped() {
    for (body, code) in [
        ("<text>a</text>", "unsupported-text"),
        ("<image href='a.png'/>", "unsupported-image"),
        ("<foreignObject/>", "unsupported-foreign-object"),
        ("<animate/>", "unsupported-animation"),
        ("<script>x</script>", "ignored-script"),
        ("<video/>", "unsupported-media"),
        ("<blob/>", "unknown-element"),
        ("<x:y xmlns:x='urn:x'/>", "foreign-element"),
        ("<path stroke='red' d='M0 0h1'/>", "unsupported-stroke"),
        ("<path style='marker-end: url(#m)' d='M0 0h1'/>", "unsupported-marker"),
        ("<path fill='url(#g)' d='M0 0h1'/>", "unsupported-paint"),
        ("<path clip-path='url(#c)' d='M0 0h1'/>", "unsupported-clip-path"),
        ("<g mask='url(#c)'/>", "unsupported-mask"),
        ("<g style='filter: blur(3px)'/>", "unsupported-filter"),
        ("<path style='transform: rotate(3deg)' d='M0 0h1'/>", "unsupported-css-geometry"),
        ("<path style='fill: red !important' d='M0 0h1'/>", "unsupported-important"),
        ("<style>g &gt; path { fill: none }</style>", "unsupported-css"),
        ("<path id='a' d='M0 0h1'/><path id='a' d='M0 0h1'/>", "duplicate-id"),
    ] {
        let (_, warnings) = load(&svg(body));
        assert_eq!(count(&warnings, code), 1, "{body}: {warnings:?}");
    }
    // Descriptions and definitions are not drawn by anybody.
    inside(
        "<title>t</title><desc/><metadata><x/></metadata><defs><rect width='1' height='1'/></defs><path d='M0 0h1'/>",
    );
}

#[test]
fn a_switch_draws_the_first_child_that_fits() {
    let drawing = inside(
        "<switch><path systemLanguage='zh' d='M1 0h1'/><path systemLanguage='de, en-GB' d='M2 0h1'/><path d='M3 0h1'/></switch>",
    );
    assert_eq!(drawing.lines.len(), 1);
    assert_eq!(drawing.lines[0].start(), [2.0, 0.0]);
}

#[test]
fn names_may_have_prefixes_and_files_no_namespace() {
    let (drawing, warnings) = load(
        "<s:svg xmlns:s='http://www.w3.org/2000/svg' xmlns='urn:other'><s:path d='M0 0h1'/><path d='M5 0h1'/></s:svg>",
    );
    assert_eq!((drawing.lines.len(), count(&warnings, "foreign-element")), (1, 1));
    let (drawing, warnings) = load("<?xml version='1.0'?>\n<!-- x -->\n<svg><path d='M0 0h1'/></svg>\n");
    assert_eq!((drawing.lines.len(), count(&warnings, "no-namespace")), (1, 1));
}

#[test]
fn sources_count_drawn_elements_in_the_order_of_the_file() {
    let drawing = inside("<path d='M0 0h1M2 0h1'/><path d=''/><circle id='c' r='1'/>");
    assert_eq!(drawing.owners, [0, 0, 1]);
    let all: Vec<_> = drawing.elements.iter().map(|e| (e.kind, &*e.name, e.source)).collect();
    assert_eq!(all, [("path", "", 0), ("circle", "c", 1)]);
}

#[test]
fn elements_with_numbers_that_are_not_finite_can_be_dropped() {
    let text = svg("<path d='M0 0L1e999 0'/><circle r='NaN'/><path d='M0 0h1'/>");
    let limits = Limits { drop_nonfinite: true, ..Limits::default() };
    let loaded = chordal_io::read(text.as_bytes(), chordal_io::Format::Svg, &limits).unwrap();
    assert_eq!(count(&loaded.warnings, "not-finite"), 2);
}

#[test]
fn what_is_put_elsewhere_or_meant_for_others_is_counted() {
    let (drawing, warnings) = load(&svg(
        "<g systemLanguage='fr'><path d='M0 0h1'/></g><g systemLanguage='en'><path d='M0 0h2'/></g>\
         <path requiredExtensions='x' d='M0 0h3'/><path transform-origin='5 5' transform='scale(2)' d='M0 0h4'/>\
         <path style='transform-box:fill-box' d='M0 0h5'/><path transform='scale(1e-170)' d='M0 0h6'/>",
    ));
    assert_eq!(drawing.lines.len(), 4);
    assert_eq!(count(&warnings, "conditional-element"), 2);
    assert_eq!(count(&warnings, "unsupported-css-geometry"), 2);
    assert_eq!(count(&warnings, "singular-transform"), 0);
    let (_, warnings) = load(
        "<?xml-stylesheet href='a.css'?><svg xmlns='http://www.w3.org/2000/svg'><path d='M0 0h1'/></svg>",
    );
    assert_eq!(count(&warnings, "unsupported-css"), 1);
}

#[test]
fn what_is_sheer_is_drawn_and_counted() {
    let (drawing, warnings) = load(&svg(
        "<path opacity='0' d='M0 0h1'/><path style='fill-opacity:.5' d='M0 0h1'/><path opacity='1' d='M0 0h1'/>",
    ));
    assert_eq!((drawing.lines.len(), count(&warnings, "unsupported-opacity")), (3, 2));
}

#[test]
fn units_of_a_place_are_in_the_slack_of_what_stands_there() {
    let (drawing, _) = load(&svg("<defs><path id='a' d='M0 0h1'/></defs><use href='#a' x='1mm'/>\
        <svg x='1mm' width='10mm' height='10mm' viewBox='0 0 2 2'><path d='M0 0h1'/></svg><use href='#a' x='1'/>"));
    let slack = |i: usize| drawing.lines[i].slack();
    assert!(
        slack(0) > 3.9e-16 && slack(1) > 3.9e-16 && slack(2) < slack(0),
        "{} {} {}",
        slack(0),
        slack(1),
        slack(2)
    );
}
