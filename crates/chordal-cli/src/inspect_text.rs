//! The text of `inspect`: the content of a file, its properties, and the findings with their places, counts
//! and cures.
use crate::numbers::{RoundingDirection, grouped, point, short, size};
use crate::summary::{SummaryLines, add_output, bound, one_way_note, plural};
use chordal::budget::advice::Cure;
use chordal_verbs::report::{
    CageFacts, ComponentFacts, DrawingFacts, EdgeFacts, EdgeMaximumFacts, EmbeddedCertificate, FieldFacts,
    FindingFacts, GeometricEdgeCounts, Inspection, LineCostFacts, NurbsEdgeFacts, NurbsJoinFacts, Output,
    ParametricEdgeCounts, PathJoinFacts, Report, SharpnessFacts, SourceFacts, SurfaceEdgeFacts, SurfaceFacts,
    ValidityFacts, WitnessFacts, cures_of_all,
};
use std::collections::BTreeMap;
use std::fmt::Write;

/// The text of a report. `argument` is the input as given on the command line.
pub fn inspect(report: &Report, argument: &str) -> String {
    let (certificate, run) = (&report.certificate, &report.run);
    let input = &certificate.input;
    let name = run.input.clone().unwrap_or_default();
    let mut lines = SummaryLines::titled(&format!("{name}: {}, {}", input.kind, input.format));
    let frame = &certificate.frame;
    lines.add_if("up", frame.up.map(str::to_owned));
    lines.add_if("unit", frame.metres_per_unit.map(|metres| format!("{metres} m")));
    if let Some(inspection) = report.inspection() {
        add_contents(&mut lines, inspection);
    }
    if let Some(output) = &certificate.output {
        add_output(&mut lines, output);
    }
    // Present for the isosurface of a volume.
    lines.add_if("bound", certificate.bound.as_ref().map(bound));
    let valid = certificate.valid.as_ref();
    let has_triangles = valid.is_some_and(ValidityFacts::has_triangles);
    let sizes = report.inspection().and_then(|inspection| inspection.sizes);
    if let Some(sizes) = sizes.filter(|_| has_triangles) {
        let (indexed, unindexed) = (size(sizes.indexed_bytes), size(sizes.unindexed_bytes));
        lines.add("geometry", format!("{indexed} indexed, {unindexed} unindexed"));
        let (acmr, best_acmr) = (sizes.acmr, sizes.acmr_ordered);
        lines
            .add("drawing", format!("{acmr:.2} vertices a triangle, {best_acmr:.2} in the best order found"));
    }
    if let Some(found) = report.inspection().and_then(|inspection| inspection.found.as_ref()) {
        lines.add("certificate", certificate_text(found));
        for source in found.sources() {
            lines.add("script", script_text(&source));
        }
    }
    let findings = report.inspection().and_then(|inspection| inspection.findings.as_ref());
    if valid.is_some() && !has_triangles {
        let is_empty = matches!(&certificate.output, Some(Output::Triangles(output)) if output.vertices == 0);
        let text = if is_empty { "none: 0 triangles, and no points" } else { "no triangles: points only" };
        lines.add("surface", text);
    } else if let (Some(valid), Some(findings)) = (valid, findings) {
        surface(&mut lines, valid);
        add_diagnosis(&mut lines, valid, findings);
        for finding in findings {
            add_finding(&mut lines, finding, valid);
        }
        add_repair_command(&mut lines, argument, findings);
    }
    add_costs(&mut lines, run.lines.as_deref().unwrap_or_default());
    lines.0
}

/// The cost of each line of a script.
fn add_costs(lines: &mut SummaryLines, costs: &[LineCostFacts]) {
    for cost in costs {
        let name = cost.line.map_or_else(|| "whole".to_owned(), |line| format!("line {line}"));
        let times = if cost.times > 1 { format!(", {} times", grouped(cost.times)) } else { String::new() };
        let seconds = cost.seconds;
        let text = match (&cost.triangles, &cost.bound, &cost.reason) {
            (Some(triangles), Some(facts), _) => {
                format!("{} triangles in {seconds:.2} s{times}, {}", grouped(*triangles), bound(facts))
            }
            (.., reason) => format!("no mesh{times}: {}", reason.as_deref().unwrap_or("no reason is known")),
        };
        lines.add(&name, text);
    }
}

fn add_contents(lines: &mut SummaryLines, inspection: &Inspection) {
    lines.add("size", size(inspection.bytes));
    lines.add_if("patches", inspection.patches.map(grouped));
    if let Some(facts) = &inspection.edges {
        edges(lines, facts);
    }
    lines.add_if("surfaces", inspection.surfaces.map(grouped));
    if let Some(facts) = &inspection.surface_edges {
        surface_edges(lines, facts);
    }
    if let Some(drawing) = &inspection.drawing {
        curves(lines, drawing);
    }
    if let Some(facts) = &inspection.cage {
        cage(lines, facts);
    }
    if let Some(volume) = &inspection.volume {
        crate::volume_text::samples(lines, volume);
    }
    if let Some(facts) = &inspection.field {
        field(lines, facts);
    }
    if let Some(parts) = inspection.parts.as_ref().filter(|parts| parts.len() != 1) {
        let instances: u64 = parts.iter().map(|part| part.instances).sum();
        lines.add("parts", format!("{} in {} places", grouped(parts.len() as u64), grouped(instances)));
    }
    let parts = inspection.parts.as_deref().unwrap_or_default();
    let drawn: u64 = parts.iter().map(|part| part.drawn).sum();
    let unique: u64 = parts.iter().map(|part| part.counts.triangles).sum();
    if drawn != unique {
        lines.add("drawn", format!("{} triangles, {} of them unique", grouped(drawn), grouped(unique)));
    }
    lines.add_if("box", inspection.bounds.map(|[low, high]| format!("{} to {}", point(low), point(high))));
}

/// The facts of a cage.
fn cage(lines: &mut SummaryLines, facts: &CageFacts) {
    lines.add("scheme", facts.scheme);
    lines.add("border", format!("{}, {}", facts.boundary, plural(facts.border_edges, "edge")));
    let names = |n: u64| match n {
        3 => "triangle".to_owned(),
        4 => "quad".to_owned(),
        n => format!("{n}-gon"),
    };
    let faces = facts.faces_by_corners.iter().map(|(corners, n)| plural(*n, &names(*corners)));
    lines.add("polygons", listed(faces, "none"));
    let valences = |n: &BTreeMap<u64, u64>| {
        listed(n.iter().map(|(valence, n)| format!("{} of {valence}", grouped(*n))), "")
    };
    let (inner, border) = (valences(&facts.irregular), valences(&facts.irregular_border));
    lines.add_if("valences", (!inner.is_empty()).then(|| format!("irregular within: {inner} edges")));
    let name = if inner.is_empty() { "valences" } else { "" };
    lines.add_if(name, (!border.is_empty()).then(|| format!("irregular on the border: {border} edges")));
    lines.add_if("creases", sharp(&facts.creases, "edge").map(|text| format!("{text}, {}", facts.creasing)));
    lines.add_if("corners", sharp(&facts.corners, "vertex"));
    lines.add_if("holes", (facts.holes > 0).then(|| plural(facts.holes, "face")));
    lines.add_if(
        "crowded",
        (facts.crowded_edges > 0)
            .then(|| plural(facts.crowded_edges, "edge of other than two faces that agree")),
    );
    lines
        .add_if("isolated", (facts.isolated_vertices > 0).then(|| plural(facts.isolated_vertices, "vertex")));
    let linear = facts.texcoords_linear.unwrap_or_default();
    lines.add_if("texcoords", facts.texcoords.map(|n| format!("{}, linear: {linear}", grouped(n))));
}

fn listed(items: impl Iterator<Item = String>, none: &str) -> String {
    let text = items.collect::<Vec<_>>().join(", ");
    if text.is_empty() { none.to_owned() } else { text }
}

/// `12 edges: 4 for ever, 8 from 0.5 to 3`
fn sharp(facts: &SharpnessFacts, what: &str) -> Option<String> {
    let forever = (facts.infinite > 0).then(|| format!("{} for ever", grouped(facts.infinite)));
    let fading = facts.range.map(|[low, high]| {
        let range = if low == high { format!("{low}") } else { format!("{low} to {high}") };
        format!("{} of sharpness {range}", grouped(facts.count - facts.infinite))
    });
    let parts = listed(forever.into_iter().chain(fading), "");
    (facts.count > 0).then(|| format!("{}: {parts}", plural(facts.count, what)))
}

/// The facts and parameters of a field.
fn field(lines: &mut SummaryLines, facts: &FieldFacts) {
    lines.add("dimensions", facts.dimensions.to_string());
    lines.add("terms", grouped(facts.terms));
    lines.add("value", format!("outside {}, inside {}", facts.outside, facts.inside));
    lines.add_if("evidence", (facts.evidence != "proved").then(|| facts.evidence.to_owned()));
    facts.assumptions.iter().for_each(|sentence| lines.add("if", sentence));
    lines.add_if("region", facts.region.map(|[low, high]| format!("{} to {}", point(low), point(high))));
    for parameter in &facts.parameters {
        let is_set = parameter.value.to_bits() != parameter.default.to_bits();
        let default = if is_set { format!(" (default {})", parameter.default) } else { String::new() };
        lines.add("parameter", format!("{} = {}{default}", parameter.name, parameter.value));
    }
}

/// The most kinks that are listed; the JSON report has more. Chosen: the worst ones fit on a screen.
const KINKS: usize = 8;

fn curves(lines: &mut SummaryLines, drawing: &DrawingFacts) {
    let filled =
        if drawing.filled > 0 { format!(", {} filled", grouped(drawing.filled)) } else { String::new() };
    lines.add("elements", format!("{}{filled}", grouped(drawing.elements)));
    let (closed, open) = (grouped(drawing.closed), grouped(drawing.open));
    lines.add("subpaths", format!("{}: {closed} closed, {open} open", grouped(drawing.subpaths)));
    let pieces = drawing.pieces;
    let counts = [
        (pieces.lines, "line"),
        (pieces.cubics, "cubic"),
        (pieces.arcs, "arc"),
        (pieces.rational, "rational piece"),
    ];
    let counts: Vec<_> =
        counts.into_iter().filter(|(n, _)| *n > 0).map(|(n, what)| plural(n, what)).collect();
    lines.add("pieces", if counts.is_empty() { "none".to_owned() } else { counts.join(", ") });
    lines.add("length", format!("about {}", short(drawing.length_estimate, RoundingDirection::Down)));
    let joins = drawing.joins;
    if joins.g0 + joins.g1 + joins.g2 > 0 {
        let seen = GeometricEdgeCounts { gaps: 0, g0: joins.g0, g1: joins.g1, g2: joins.g2 };
        let run = ParametricEdgeCounts { c0: joins.c0, c1: joins.c1, c2: joins.c2 };
        let shown = drawing.worst.len().min(KINKS);
        add_classes(lines, (&seen, &run), drawing.worst[..shown].iter().map(path_join_text));
    }
}

/// `path 3 'leaf', piece 2: 90.0° at (1, 2, 0)`
fn path_join_text(join: &PathJoinFacts) -> String {
    let name = if join.name.is_empty() { String::new() } else { format!(" '{}'", join.name.escape_debug()) };
    let number = |x: f64| short(x, RoundingDirection::Nearest);
    let what = match (join.geometric, join.angle_deg, join.curvature_gap, join.curvatures) {
        (0, Some(deg), ..) => format!("{deg:.1}°"),
        (0, None, ..) => "no direction".to_owned(),
        (_, _, Some(gap), [Some(before), Some(after)]) => {
            let side = if gap * gap > before * before + after * after { " on the other side" } else { "" };
            format!("curvature jumps by {}, from {} to {}{side}", number(gap), number(before), number(after))
        }
        _ => "no curvature".to_owned(),
    };
    format!("{} {}{name}, piece {}: {what} at {}", join.kind, join.element, join.piece, point(join.at))
}

/// The number of edges of each kind, and of those whose neighbours face opposite ways.
fn add_edge_counts(lines: &mut SummaryLines, kinds: &[(u64, &str)], opposed: u64) {
    let counted = kinds.iter().filter(|(n, _)| *n > 0).map(|(n, kind)| format!("{} {kind}", grouped(*n)));
    lines.add("edges", listed(counted, "none"));
    lines.add_if("fronts", (opposed > 0).then(|| format!("disagree across {}", plural(opposed, "edge"))));
}

/// The edges between patches, and their smoothness.
fn edges(lines: &mut SummaryLines, facts: &SurfaceEdgeFacts) {
    let kinds = [
        (facts.shared, "shared"),
        (facts.boundary, "on the boundary"),
        (facts.collapsed, "collapsed to points"),
        (facts.branching, "of three patches or more"),
    ];
    add_edge_counts(lines, &kinds, facts.opposed);
    if facts.shared == 0 {
        return;
    }
    let shown = facts.worst.len().min(KINKS);
    add_classes(lines, (&facts.geometric, &facts.parametric), facts.worst[..shown].iter().map(edge_text));
}

/// The edges between NURBS surfaces, and the smoothness across edges and knots.
fn surface_edges(lines: &mut SummaryLines, facts: &NurbsEdgeFacts) {
    let kinds = [
        (facts.knot_lines, "across knots"),
        (facts.shared, "shared"),
        (facts.boundary, "on the boundary"),
        (facts.collapsed, "collapsed to points"),
        (facts.branching, "along several others"),
    ];
    add_edge_counts(lines, &kinds, facts.opposed);
    if facts.shared + facts.knot_lines == 0 {
        return;
    }
    let shown = facts.worst.len().min(KINKS);
    add_classes(lines, (&facts.geometric, &facts.parametric), facts.worst[..shown].iter().map(join_text));
}

/// The smoothness classes of edges, and the texts of the worst edges.
fn add_classes(
    lines: &mut SummaryLines,
    (geometric, parametric): (&GeometricEdgeCounts, &ParametricEdgeCounts),
    worst: impl ExactSizeIterator<Item = String>,
) {
    let gaps =
        if geometric.gaps > 0 { format!("{}, ", plural(geometric.gaps, "gap")) } else { String::new() };
    let smooth = format!("{} G1, {} G2", grouped(geometric.g1), grouped(geometric.g2));
    lines.add("joins", format!("{gaps}{}, {smooth}", plural(geometric.g0, "kink")));
    let [c0, c1, c2] = [parametric.c0, parametric.c1, parametric.c2].map(grouped);
    lines.add("", format!("{c0} C0, {c1} C1, {c2} C2"));
    let shown = worst.len() as u64;
    worst.for_each(|text| lines.add("", text));
    let n_more = geometric.gaps + geometric.g0 + geometric.g1 - shown;
    lines.add_if("", (n_more > 0).then(|| format!("and {} more that are not G2", grouped(n_more))));
}

/// `patch 3 right, 7 left: 30° at (1, 2, 0), u 1, v 0.25`
fn edge_text(edge: &EdgeFacts) -> String {
    let ([a, b], [side_a, side_b]) = (edge.patches, edge.sides);
    let what = worst_text(edge.geometric, [Some(edge.position_gap), edge.angle_deg, edge.curvature_gap]);
    format!("patch {a} {side_a}, {b} {side_b}: {what}")
}

/// `surface 0 at u 0.5: 30° at …` for knots, `surface 0 at u 1, 2 at v 0: …` for a shared edge
fn join_text(join: &NurbsJoinFacts) -> String {
    let what = worst_text(join.geometric, [Some(join.position_gap), join.angle_deg, join.curvature_gap]);
    let number = |x: f64| short(x, RoundingDirection::Nearest);
    let ([a, b], [line_a, line_b]) = (join.surfaces, join.lines);
    let first = format!("surface {a} at {} {}", line_a.constant, number(line_a.at));
    if a == b && line_a == line_b {
        return format!("{first}: {what}");
    }
    format!("{first}, {b} at {} {}: {what}", line_b.constant, number(line_b.at))
}

/// The defect of an edge of a class: its largest gap, angle or jump of the curvature, with the place.
fn worst_text(class: Option<u8>, [gap, angle, bend]: [Option<EdgeMaximumFacts>; 3]) -> String {
    let number = |x: f64| short(x, RoundingDirection::Nearest);
    let (what, worst) = match (class, angle, bend) {
        (None, ..) => (gap.map_or_else(String::new, |gap| format!("gap of {}", number(gap.value))), gap),
        (Some(0), Some(angle), _) => (format!("{}°", number(angle.value)), Some(angle)),
        (Some(0), None, _) => ("no direction".to_owned(), None),
        (Some(_), _, Some(gap)) => (format!("curvature jumps by {}", number(gap.value)), Some(gap)),
        (Some(_), _, None) => ("no curvature".to_owned(), None),
    };
    let place = worst.map_or_else(String::new, |worst| {
        format!(" at {}, u {}, v {}", point(worst.at), number(worst.uv[0]), number(worst.uv[1]))
    });
    format!("{what}{place}")
}

/// The measures and properties of the surface.
fn surface(lines: &mut SummaryLines, valid: &ValidityFacts) {
    let (counts, Some(anatomy)) = (&valid.counts, &valid.anatomy) else { return };
    let mut facts = vec![format!("area {}", short(anatomy.area, RoundingDirection::Nearest))];
    facts
        .extend(anatomy.volume.map(|volume| format!("volume {}", short(volume, RoundingDirection::Nearest))));
    facts.extend(counts.genus.map(|genus| format!("genus {genus}")));
    facts.push(format!("Euler number {}", counts.euler));
    let mean = anatomy.triangles_per_vertex;
    facts.extend(mean.map(|mean| {
        let mean = short(mean, RoundingDirection::Nearest);
        format!("{mean} triangle{} a vertex", if mean == "1" { "" } else { "s" })
    }));
    lines.add("surface", facts.join(", "));
    if !anatomy.in_place {
        lines.add("", "areas, volumes and places below in the parts' own coordinates");
    }
    // If all triangles are collapsed there is no surface, so no property is stated or denied.
    if counts.components > 0 {
        let (is, is_not) = properties(valid, anatomy);
        lines.add_if("is", (!is.is_empty()).then(|| is.join(", ")));
        lines.add_if("is not", (!is_not.is_empty()).then(|| is_not.join(", ")));
    }
    if counts.components > 1 {
        components(lines, counts.components, &anatomy.component_list);
    }
}

/// The properties that hold, and those that do not; unknown ones are in neither list.
fn properties(valid: &ValidityFacts, anatomy: &SurfaceFacts) -> (Vec<&'static str>, Vec<&'static str>) {
    let counts = &valid.counts;
    let sides = if counts.oriented || counts.orientable { "oriented" } else { "orientable" };
    let list = [
        ("closed", Some(counts.closed)),
        ("manifold", Some(counts.manifold)),
        (sides, Some(counts.oriented)),
        ("outward", anatomy.outward),
        ("free of self-intersections", anatomy.self_intersections.map(|count| count == 0)),
    ];
    let names =
        |wanted: bool| list.iter().filter(|(_, is)| *is == Some(wanted)).map(|(name, _)| *name).collect();
    (names(true), names(false))
}

/// The most components that are listed; the JSON report has more. Chosen: the largest ones fit on a screen.
const ROWS: usize = 6;

fn components(lines: &mut SummaryLines, count: u64, listed: &[ComponentFacts]) {
    let shown = &listed[..listed.len().min(ROWS)];
    let largest = if count > shown.len() as u64 { ", the largest are" } else { "" };
    lines.add("components", format!("{}{largest}", grouped(count)));
    let several_parts = listed.iter().any(|component| component.part != listed[0].part);
    let mut table =
        vec![["triangles", "first face", "closed", "front", "genus", "area", "volume"].map(str::to_owned)];
    for component in shown {
        let first = if several_parts {
            format!("{}:{}", component.part, component.first_face)
        } else {
            component.first_face.to_string()
        };
        table.push([
            grouped(component.triangles),
            first,
            if component.closed { "yes".to_owned() } else { plural(component.boundary_loops, "loop") },
            component.facing.replace('-', " "),
            component.genus.map_or_else(|| "-".to_owned(), |genus| genus.to_string()),
            short(component.area, RoundingDirection::Nearest),
            component
                .volume
                .map_or_else(|| "-".to_owned(), |volume| short(volume, RoundingDirection::Nearest)),
        ]);
    }
    let widths: [usize; 7] =
        std::array::from_fn(|k| table.iter().map(|row| row[k].chars().count()).max().unwrap_or(0));
    for row in table {
        let cells: Vec<String> =
            row.iter().zip(widths).map(|(cell, width)| format!("{cell:>width$}")).collect();
        lines.add("", cells.join("  "));
    }
}

/// The number of findings, in one line.
fn add_diagnosis(lines: &mut SummaryLines, valid: &ValidityFacts, findings: &[FindingFacts]) {
    let weighing = |weight: &str| findings.iter().filter(|finding| finding.weight == weight).count() as u64;
    let (faults, remarks) = (weighing("fault"), weighing("remark"));
    let counted: Vec<String> = [(faults, "fault"), (remarks, "remark")]
        .into_iter()
        .filter(|(n, _)| *n > 0)
        .map(|(n, what)| plural(n, what))
        .collect();
    lines.add("found", if counted.is_empty() { "nothing to mend".to_owned() } else { counted.join(", ") });
    let (counts, other) = (&valid.counts, &valid.other);
    if counts.boundary_edges != other.counts.boundary_edges {
        let edges = match other.counts.boundary_edges {
            0 => "no boundary edges".to_owned(),
            n => plural(n, "boundary edge"),
        };
        lines.add("", format!("{edges} where vertices meet by {}", other.topology));
    }
}

/// The most places of a finding that are listed; the JSON report has more. Chosen: two show whether a fault
/// is local.
const PLACES: usize = 2;

fn add_finding(lines: &mut SummaryLines, finding: &FindingFacts, valid: &ValidityFacts) {
    let FindingFacts { count, words, means, cures, advice, .. } = finding;
    let detail = finding_detail(finding.of, valid);
    // Writing to a text does not fail.
    let _ = writeln!(lines.0, "\n  {} {words}{detail}: {means}", grouped(*count));
    let places: Vec<String> = witness_texts(finding.of, valid).take(PLACES).collect();
    let mut line = |name: &str, text: &str| {
        let _ = writeln!(lines.0, "    {name:<9} {text}");
    };
    for (i, place) in places.iter().enumerate() {
        line(if i == 0 { "where" } else { "" }, place);
    }
    let n_more = count.saturating_sub(places.len() as u64);
    if n_more > 0 && !places.is_empty() {
        line("", &format!("and {} more", grouped(n_more)));
    }
    if let Some(advice) = advice {
        line("advice", advice);
    } else {
        line("cure", &options(cures));
    }
}

/// A further count of a finding.
fn finding_detail(of: &str, valid: &ValidityFacts) -> String {
    let counts = &valid.counts;
    match of {
        "boundary_edges" if counts.boundary_loops > 0 => {
            format!(" in {}", plural(counts.boundary_loops, "loop"))
        }
        "boundary_edges" if counts.boundary_chains > 0 => {
            format!(" in {}", plural(counts.boundary_chains, "open chain"))
        }
        "duplicate_faces" if counts.opposite_faces > 0 => {
            format!(", {} back to back", grouped(counts.opposite_faces))
        }
        _ => String::new(),
    }
}

/// The known places of a finding.
pub(crate) fn witness_texts<'a>(of: &'a str, valid: &'a ValidityFacts) -> impl Iterator<Item = String> + 'a {
    let several_parts = valid.parts.len() > 1;
    let named = valid.witnesses.iter().flatten().filter(move |witness| witness.of == of);
    named.map(move |witness| {
        if let (Some(other), [f, g]) = (witness.other_part, &witness.faces[..]) {
            let part = witness.part;
            let at = point(witness.at);
            return format!(
                "triangle {f} of part {part} and triangle {g} of part {other} at {at} in the scene"
            );
        }
        let part = if several_parts { format!("part {}, ", witness.part) } else { String::new() };
        format!("{part}{} at {}", witness_text(witness), point(witness.at))
    })
}

/// `edge 3-7 of triangles 12, 14`; indices start at 0.
fn witness_text(witness: &WitnessFacts) -> String {
    let list = |numbers: &[u32]| numbers.iter().map(u32::to_string).collect::<Vec<_>>().join(", ");
    let triangles =
        |faces: &[u32]| format!("triangle{} {}", if faces.len() == 1 { "" } else { "s" }, list(faces));
    match (&witness.vertices[..], &witness.faces[..]) {
        ([vertex], []) => format!("vertex {vertex}"),
        ([vertex, other], []) => format!("vertex {vertex}, equal to {other},"),
        ([a, b], faces) => format!("edge {a}-{b} of {}", triangles(faces)),
        ([vertex, a, b], faces) => format!("vertex {vertex} on edge {a}-{b} of {}", triangles(faces)),
        (_, faces) => triangles(faces),
    }
}

/// A name quoted for a shell.
pub(crate) fn quoted(name: &str) -> String {
    let plain = |c: char| c.is_ascii_alphanumeric() || "-_./+:@,=".contains(c);
    if name.chars().all(plain) { name.to_owned() } else { format!("'{}'", name.replace('\'', r"'\''")) }
}

/// The command that applies all cures.
fn add_repair_command(lines: &mut SummaryLines, name: &str, findings: &[FindingFacts]) {
    let cures = cures_of_all(findings);
    if !cures.is_empty() {
        let _ = writeln!(
            lines.0,
            "\n  {:<11} chordal mend {} {} -o OUT",
            "to mend",
            quoted(name),
            options(&cures)
        );
    }
}

fn certificate_text(embedded: &EmbeddedCertificate) -> String {
    let number = |pointer: &str| embedded.certificate.pointer(pointer).and_then(serde_json::Value::as_f64);
    let text = |pointer: &str| embedded.certificate.pointer(pointer).and_then(serde_json::Value::as_str);
    let bound = match (number("/bound/at_least"), number("/bound/at_most"), text("/bound/evidence")) {
        (Some(least), Some(most), Some(evidence)) => {
            let one_way = one_way_note(text("/bound/metric").unwrap_or_default());
            let (least, most) = (short(least, RoundingDirection::Down), short(most, RoundingDirection::Up));
            format!("between {least} and {most} ({evidence}{one_way})")
        }
        _ => "no bound".to_owned(),
    };
    if embedded.differs.is_empty() {
        bound
    } else {
        format!("{bound}, but for another shape: {}", embedded.differs.join(", "))
    }
}

/// A script in one line: its name, its lines, and the parameters that were set.
pub fn script_text(source: &SourceFacts) -> String {
    let set = |(name, value): (&String, &f64)| format!(" --set {name}={value}");
    let set: String = source.parameters.iter().map(set).collect();
    format!("{}, {} lines{set}", quoted(&source.name), source.text.lines().count())
}

/// The options of `chordal mend`.
fn options(cures: &[Cure]) -> String {
    let options: Vec<String> = cures.iter().map(|cure| format!("--{}", cure.name())).collect();
    options.join(" ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_quoted_where_a_shell_would_part_them() {
        assert_eq!(quoted("a/b-c.obj"), "a/b-c.obj");
        assert_eq!(quoted("my part.obj"), "'my part.obj'");
        assert_eq!(quoted("it's.obj"), r"'it'\''s.obj'");
        assert_eq!(quoted("$(x).obj"), "'$(x).obj'");
    }
}
