//! The verbs on drawings: polylines, filled triangles, what they refuse, and what they say of kinks.
use chordal::budget::{PixelBudget, Reference};
use chordal::{Job, check};
use chordal_io::{Axis, Format, Polylines};
use chordal_verbs::report::{Inspection, Output};
use chordal_verbs::{BudgetSpec, FormatHint, Input, MeshFailure, MeshOutcome, Spacing, inspect, load, mesh};

const RING: &str = "<svg xmlns='http://www.w3.org/2000/svg' viewBox='0 0 10 10'><path id='ring' fill-rule='evenodd' \
    d='M1 5a4 4 0 0 1 8 0a4 4 0 0 1-8 0M3 5a2 2 0 0 1 4 0a2 2 0 0 1-4 0'/></svg>";

fn drawing(text: &str) -> Input {
    load(
        text.as_bytes(),
        FormatHint { format: Some(Format::Svg), ..FormatHint::default() },
        &Default::default(),
    )
    .unwrap()
}

fn json(text: &str) -> Input {
    load(
        text.as_bytes(),
        FormatHint { format: Some(Format::Json), ..FormatHint::default() },
        &Default::default(),
    )
    .unwrap()
}

fn length(text: &str) -> BudgetSpec {
    BudgetSpec { length: Some(text.parse().unwrap()), ..BudgetSpec::default() }
}

#[track_caller]
fn made(input: Input, spec: &BudgetSpec, to: Format) -> MeshOutcome {
    mesh(input, spec, to, &Job::default()).unwrap_or_else(|error| panic!("{error}"))
}

fn segments(outcome: &MeshOutcome) -> u64 {
    outcome.certificate.output.unwrap().polylines().unwrap().segments
}

#[test]
fn a_drawing_becomes_one_polyline_a_subpath_within_the_budget() {
    let outcome = made(drawing(RING), &length("0.01"), Format::Json);
    let Some(Polylines::Plane(drawn)) = outcome.polylines() else { panic!("no polylines") };
    assert_eq!((drawn.lines.len(), &drawn.owners[..]), (2, &[0, 0][..]));
    assert!(drawn.lines.iter().all(|line| !line.closed), "the file does not close them");
    assert!(outcome.bound.at_most().unwrap() <= 0.01 && outcome.bound.reference == Reference::Curves);
    // Every vertex lies on a circle, and no segment is farther inside than the bound.
    for (line, r) in drawn.lines.iter().zip([4.0, 2.0]) {
        for [a, b] in line.segments() {
            let far = |p: [f64; 2]| ((p[0] - 5.0).powi(2) + (p[1] - 5.0).powi(2)).sqrt();
            assert!((far(a) - r).abs() < 1e-12);
            let middle = [(a[0] + b[0]) / 2.0, (a[1] + b[1]) / 2.0];
            assert!(r - far(middle) <= 0.01);
        }
    }
    let mut twice = Vec::new();
    for _ in 0..2 {
        let mut bytes = Vec::new();
        made(drawing(RING), &length("0.01"), Format::Json).write(&mut bytes).unwrap();
        twice.push(bytes);
    }
    assert_eq!(twice[0], twice[1]);
}

#[test]
fn a_percentage_is_of_the_drawing_s_own_box() {
    let outcome = made(drawing(RING), &length("1%"), Format::Json);
    let asked = outcome.certificate.budget.as_ref().unwrap().length.unwrap();
    let whole = 0.01 * 8.0 * 2.0_f64.sqrt();
    assert!(asked <= whole && asked > 0.999 * whole, "{asked} of {whole}");
}

#[test]
fn units_come_from_the_size_of_the_picture() {
    let text = RING.replace("viewBox", "width='10cm' height='10cm' viewBox");
    let outcome = made(drawing(&text), &length("1mm"), Format::Svg);
    let asked = outcome.certificate.budget.as_ref().unwrap().length.unwrap();
    assert!((asked - 0.1).abs() < 1e-15);
    let refused = mesh(drawing(RING), &length("1mm"), Format::Svg, &Job::default()).unwrap_err();
    assert_eq!(refused.exit_code(), 2);
}

#[test]
fn segments_are_counted_and_equal_steps_take_more_of_them() {
    let spec = BudgetSpec { segments: Some(24), ..BudgetSpec::default() };
    let outcome = made(drawing(RING), &spec, Format::Json);
    assert!(segments(&outcome) <= 24 && segments(&outcome) >= 20);
    assert_eq!(outcome.certificate.budget.as_ref().unwrap().segments, Some(24));
    let cubic = "<svg xmlns='http://www.w3.org/2000/svg'><path d='M0 0C0 9 0 1 9 0'/></svg>";
    let even = BudgetSpec { spacing: Spacing::Even, ..length("1e-4") };
    let [few, many] = [length("1e-4"), even].map(|spec| segments(&made(drawing(cubic), &spec, Format::Json)));
    assert!(few < many, "{few} {many}");
    let lost = mesh(
        drawing(RING),
        &BudgetSpec { segments: Some(3), ..length("1e-3") },
        Format::Json,
        &Job::default(),
    );
    let Err(MeshFailure::Unmet(best)) = lost else { panic!("met with 3 segments") };
    assert!(MeshFailure::Unmet(best).to_string().contains("segments"));
}

#[test]
fn pixels_at_a_view_are_bounded_in_the_plane_of_the_drawing() {
    let view = "1000x1000 height=10 eye=5,5,9 target=5,5,0 up=0,1,0".parse();
    let view = view.unwrap_or_else(|error| panic!("{error}"));
    let pixels = PixelBudget { pixels: "0.5px".parse().unwrap(), view };
    let spec = BudgetSpec { pixels: Some(pixels), ..BudgetSpec::default() };
    for to in [Format::Json, Format::Svg, Format::Glb, Format::Obj] {
        let outcome = made(drawing(RING), &spec, to);
        let found = outcome.bound.pixels.unwrap();
        // A hundred pixels a unit.
        assert!(found <= 0.5 && outcome.bound.at_most().unwrap() <= 0.005_000_001, "{to}: {found}");
        assert!(outcome.bound.at_most().unwrap() > 0.002, "{to}: {}", outcome.bound);
    }
}

#[test]
fn counts_of_the_wrong_kind_are_usage_errors_with_a_hint() {
    let triangles = BudgetSpec { triangles: Some(5), ..BudgetSpec::default() };
    let some = BudgetSpec { segments: Some(5), ..BudgetSpec::default() };
    let obj =
        || load(b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", FormatHint::default(), &Default::default()).unwrap();
    let space = || json(r#"{"curves": [{"control": [[0,0,0],[1,0,0],[2,1,0],[3,1,9]]}]}"#);
    for (input, spec, to, part) in [
        (drawing(RING), &triangles, Format::Json, "'segments=5'"),
        (drawing(RING), &some, Format::Glb, "'triangles=5'"),
        (obj(), &some, Format::Glb, "'triangles=5'"),
        (obj(), &triangles, Format::Json, "triangles"),
        (obj(), &triangles, Format::Svg, "obj, ply, stl, glb, gltf, off, 3mf, vtp, usda, usdz"),
        (drawing(RING), &triangles, Format::Bpt, "only read"),
        (space(), &some, Format::Svg, ".json"),
        (space(), &triangles, Format::Glb, "json"),
    ] {
        let failure = mesh(input, spec, to, &Job::default()).unwrap_err();
        assert_eq!((failure.code(), failure.exit_code()), ("usage", 2), "{failure}");
        assert!(failure.to_string().contains(part), "{failure}");
    }
}

#[test]
fn closed_outlines_fill_with_triangles_in_every_mesh_format() {
    for to in [Format::Obj, Format::Ply, Format::Stl, Format::Glb, Format::Off] {
        let outcome = made(drawing(RING), &length("0.01"), to);
        let at_most = outcome.bound.at_most().unwrap();
        assert!(at_most <= 0.01 && at_most > 0.005, "{to}: {at_most}");
        let scene = outcome.scene().unwrap();
        assert_eq!(scene.frame.up, Some(Axis::Y));
        let mesh = &scene.parts[0].mesh;
        // The area of a ring, off by no more than the bound along its borders.
        let (area, true_area) = (check::findings::measure(mesh).area, 12.0 * std::f64::consts::PI);
        assert!((area - true_area).abs() <= at_most * 12.0 * std::f64::consts::PI, "{to}: {area}");
        // Face up, in the plane, with y upwards.
        for face in 0..mesh.faces().len() {
            let [a, b, c] = mesh.corners(face);
            assert!((b[0] - a[0]) * (c[1] - a[1]) > (b[1] - a[1]) * (c[0] - a[0]));
            assert!(a[2] == 0.0 && a[1] < 0.0);
        }
        let valid = &outcome.certificate.valid.as_ref().unwrap().counts;
        assert_eq!(
            (valid.t_junctions, valid.zero_area_faces, valid.manifold, valid.boundary_loops),
            (0, 0, true, 2)
        );
        assert!(outcome.certificate.notes.iter().any(|note| note.contains("no farther")));
    }
}

#[test]
fn triangles_can_be_counted_and_what_fills_nothing_is_said() {
    for most in [20, 100, 1000] {
        let spec = BudgetSpec { triangles: Some(most), ..BudgetSpec::default() };
        let outcome = made(drawing(RING), &spec, Format::Ply);
        let n = outcome.certificate.output.unwrap().triangles().unwrap().triangles;
        assert!(n <= most && n + 8 + most / 100 >= most, "{n} of {most}");
    }
    // A ring cannot be had for two triangles: what is left has a bound as large as the ring is broad, or says
    // why.
    let spec = BudgetSpec { triangles: Some(2), ..BudgetSpec::default() };
    let coarse = made(drawing(RING), &spec, Format::Ply);
    assert!(coarse.bound.at_most().unwrap() >= 2.0, "{}", coarse.bound);
    let both = BudgetSpec { triangles: Some(2), ..length("0.01") };
    assert!(matches!(mesh(drawing(RING), &both, Format::Ply, &Job::default()), Err(MeshFailure::Unmet(_))));
    let thin = "<svg xmlns='http://www.w3.org/2000/svg'><path d='M0 0L9 1z'/></svg>";
    let outcome = made(drawing(thin), &length("1"), Format::Ply);
    assert!(outcome.certificate.notes.iter().any(|note| note.contains("no triangles")));
    let hollow = RING.replace("<path", "<path fill='none'");
    let failure = mesh(drawing(&hollow), &length("0.1"), Format::Glb, &Job::default()).unwrap_err();
    assert_eq!((failure.code(), failure.exit_code()), ("empty", 3));
}

#[test]
fn a_length_below_the_grid_is_refused_before_the_work() {
    let failure = mesh(drawing(RING), &length("1e-12"), Format::Obj, &Job::default()).unwrap_err();
    assert_eq!(failure.code(), "below-precision");
}

#[test]
fn curves_in_space_become_polylines_in_json() {
    let input = json(r#"{"curves": [{"control": [[0,0,0],[0,3,0],[3,3,3],[3,0,9]], "source": 4}]}"#);
    assert_eq!(input.shape.kind(), "curves");
    let outcome = made(input, &length("0.1%"), Format::Json);
    let mut bytes = Vec::new();
    outcome.write(&mut bytes).unwrap();
    let text = String::from_utf8(bytes).unwrap();
    assert!(text.contains("[3, 0, 9]") && text.contains("\"source\": 4"), "{text}");
}

#[test]
fn polylines_read_back_with_their_certificate_and_count_the_same() {
    let outcome = made(drawing(RING), &length("0.01"), Format::Json);
    for to in [Format::Json, Format::Svg] {
        let outcome = MeshOutcome { format: to, ..outcome.clone() };
        let mut bytes = Vec::new();
        outcome.write(&mut bytes).unwrap();
        let read = load(&bytes, FormatHint::default(), &Default::default()).unwrap();
        assert_eq!(read.format, to, "by its content");
        let report = inspect(&read);
        assert_eq!(report.certificate.output, outcome.certificate.output);
        let found = report.inspection().unwrap().found.as_ref().unwrap();
        assert_eq!((&found.certificate, found.differs.len()), (&outcome.certificate.to_value(), 0), "{to}");
    }
    assert!(matches!(outcome.certificate.output, Some(Output::Polylines(_))));
}

fn inspected(text: &str) -> Inspection {
    inspect(&drawing(text)).inspection().unwrap().clone()
}

#[test]
fn inspect_says_where_a_path_kinks() {
    let text = "<svg xmlns='http://www.w3.org/2000/svg'><circle r='1'/>\
        <path id='p' d='M0 0h4v4M0 9c0 1 1 2 2 2s2-1 2-2'/><rect width='9' height='9' rx='2'/></svg>";
    let inspection = inspected(text);
    let facts = inspection.drawing.as_ref().unwrap();
    assert_eq!((facts.elements, facts.subpaths, facts.closed, facts.open), (3, 4, 2, 2));
    assert_eq!((facts.pieces.lines, facts.pieces.cubics, facts.pieces.arcs), (6, 2, 5));
    assert_eq!(facts.joins.g0, 1, "{facts:?}");
    let kink = &inspection.worst_joins()[0];
    assert_eq!(
        (kink.kind, kink.name.as_str(), kink.element, kink.subpath, kink.piece),
        ("path", "p", 1, 1, 1)
    );
    assert_eq!((kink.at, kink.angle_deg), ([4.0, 0.0, 0.0], Some(90.0)));
    // The kink, and lines that run into arcs of radius 2, twice at each corner of the rectangle; the two cubics and the
    // circle are C2.
    assert_eq!((facts.joins.g1, facts.joins.c0, facts.joins.c1, facts.joins.c2), (8, 9, 0, 2));
    let jump = &facts.worst[1];
    assert_eq!((jump.geometric, jump.kind, facts.worst.len()), (1, "rect", 9));
    assert!((jump.curvature_gap.unwrap() - 0.5).abs() < 1e-12, "{jump:?}");
    let star = "l1 1 1-1".repeat(100);
    let many = inspected(&format!("<svg xmlns='http://www.w3.org/2000/svg'><path d='M0 0{star}'/></svg>"));
    let facts = many.drawing.unwrap();
    assert_eq!((facts.joins.g0, facts.worst.len()), (199, 32));
    assert!((facts.length_estimate - 200.0 * 2.0_f64.sqrt()).abs() < 1e-9);
}
