//! Reports for people: a few aligned lines.
use crate::numbers::{Toward, grouped, point, short, size};
use chordal_verbs::report::{
    BoundFacts, DrawingFacts, Found, Inspection, KinkFacts, Output, OutputFacts, Report, Valid,
};
use std::fmt::Write;

/// Lines of a name and a value, the values below each other.
pub(crate) struct Lines(String);

impl Lines {
    pub fn titled(title: &str) -> Self {
        Self(format!("{title}\n"))
    }

    pub fn add(&mut self, name: &str, value: impl AsRef<str>) {
        // Writing to a text does not fail.
        let _ = writeln!(self.0, "  {name:<11} {}", value.as_ref());
    }

    pub fn add_if(&mut self, name: &str, value: Option<String>) {
        if let Some(value) = value {
            self.add(name, value);
        }
    }

    /// The text.
    pub fn finish(self) -> String {
        self.0
    }
}

/// What `mesh` did.
pub fn mesh(report: &Report) -> String {
    let (certificate, run) = (&report.certificate, &report.run);
    let name = |name: &Option<String>| name.clone().unwrap_or_default();
    let mut lines = Lines::titled(&format!("{} -> {}", name(&run.input), name(&run.output)));
    if let Some(output) = &certificate.output {
        made(&mut lines, output);
    }
    if let Some(facts) = &certificate.bound {
        lines.add("bound", bound(facts));
        let view = certificate.budget.as_ref().and_then(|budget| budget.view.as_ref());
        lines.add_if(
            "pixels",
            facts
                .pixels
                .zip(view)
                .map(|(pixels, view)| format!("at most {} at {}", short(pixels, Toward::Up), view.text)),
        );
    }
    if let Some(valid) = &certificate.valid {
        soundness(&mut lines, valid);
    }
    lines.add_if("size", run.bytes.map(size));
    lines.add_if("seconds", run.seconds.map(|seconds| format!("{seconds:.2}")));
    lines.0
}

/// What `inspect` found.
pub fn inspect(report: &Report) -> String {
    let (certificate, run) = (&report.certificate, &report.run);
    let input = &certificate.input;
    let name = run.input.clone().unwrap_or_default();
    let mut lines = Lines::titled(&format!("{name}: {}, {}", input.kind, input.format));
    let frame = &certificate.frame;
    lines.add_if("up", frame.up.map(str::to_owned));
    lines.add_if("unit", frame.metres_per_unit.map(|metres| format!("{metres} m")));
    if let Some(inspection) = &report.inspection {
        holds(&mut lines, inspection);
    }
    if let Some(output) = &certificate.output {
        made(&mut lines, output);
    }
    if let Some(sizes) = report.inspection.as_ref().and_then(|inspection| inspection.sizes) {
        let (indexed, unindexed) = (size(sizes.indexed_bytes), size(sizes.unindexed_bytes));
        lines.add("geometry", format!("{indexed} indexed, {unindexed} unindexed"));
    }
    if let Some(valid) = &certificate.valid {
        soundness(&mut lines, valid);
        oddities(&mut lines, valid);
    }
    if let Some(found) = report.inspection.as_ref().and_then(|inspection| inspection.found.as_ref()) {
        lines.add("certificate", certified(found));
    }
    lines.0
}

/// What a picture shows.
pub fn render(report: &Report, picture: &str) -> String {
    let (certificate, run) = (&report.certificate, &report.run);
    let name = |name: &Option<String>| name.clone().unwrap_or_default();
    let mut lines = Lines::titled(&format!("{} -> {}", name(&run.input), name(&run.output)));
    lines.add("picture", picture);
    if let Some(output) = &certificate.output {
        made(&mut lines, output);
    }
    if let Some(facts) = &certificate.bound {
        lines.add("bound", bound(facts));
    }
    lines.add_if("size", run.bytes.map(size));
    lines.add_if("seconds", run.seconds.map(|seconds| format!("{seconds:.2}")));
    lines.0
}

fn holds(lines: &mut Lines, inspection: &Inspection) {
    lines.add("size", size(inspection.bytes));
    lines.add_if("patches", inspection.patches.map(grouped));
    if let Some(drawing) = &inspection.drawing {
        curves(lines, drawing);
    }
    if let Some(parts) = inspection.parts.as_ref().filter(|parts| parts.len() != 1) {
        let instances: u64 = parts.iter().map(|part| part.instances).sum();
        lines.add("parts", format!("{} in {} places", grouped(parts.len() as u64), grouped(instances)));
    }
    lines.add_if("box", inspection.bounds.map(|[low, high]| format!("{} to {}", point(low), point(high))));
}

/// How many kinks are told one by one; the report has more.
const KINKS: usize = 8;

fn curves(lines: &mut Lines, drawing: &DrawingFacts) {
    let filled =
        if drawing.filled > 0 { format!(", {} filled", grouped(drawing.filled)) } else { String::new() };
    lines.add("elements", format!("{}{filled}", grouped(drawing.elements)));
    let (closed, open) = (grouped(drawing.closed), grouped(drawing.open));
    lines.add("subpaths", format!("{}: {closed} closed, {open} open", grouped(drawing.subpaths)));
    let pieces = drawing.pieces;
    let all = [(pieces.lines, "line"), (pieces.cubics, "cubic"), (pieces.arcs, "arc")];
    let all: Vec<_> = all.into_iter().filter(|(n, _)| *n > 0).map(|(n, what)| plural(n, what)).collect();
    lines.add("pieces", if all.is_empty() { "none".to_owned() } else { all.join(", ") });
    lines.add("length", format!("about {}", short(drawing.length_estimate, Toward::Down)));
    let joins = drawing.joins;
    if joins.g0 + joins.g1 + joins.g2 > 0 {
        let smooth = format!("{} G1, {} G2", grouped(joins.g1), grouped(joins.g2));
        lines.add("joins", format!("{}, {smooth}", plural(joins.g0, "kink")));
    }
    for kink in drawing.kinks.iter().take(KINKS) {
        lines.add("", turned(kink));
    }
    let told = drawing.kinks.len().min(KINKS) as u64;
    if joins.g0 > told {
        lines.add("", format!("and {} more", grouped(joins.g0 - told)));
    }
}

/// `path 3 'leaf', piece 2: 90° at (1, 2, 0)`
fn turned(kink: &KinkFacts) -> String {
    let name = if kink.name.is_empty() { String::new() } else { format!(" '{}'", kink.name.escape_debug()) };
    let angle = kink.angle_deg.map_or_else(|| "no direction".to_owned(), |deg| format!("{deg:.1}°"));
    format!("{} {}{name}, piece {}: {angle} at {}", kink.kind, kink.element, kink.piece, point(kink.at))
}

fn made(lines: &mut Lines, output: &Output) {
    match output {
        Output::Triangles(output) => triangles(lines, output),
        Output::Polylines(output) => {
            lines.add("polylines", grouped(output.polylines));
            lines.add(
                "segments",
                format!("{} between {} points", grouped(output.segments), grouped(output.points)),
            );
        }
    }
}

fn triangles(lines: &mut Lines, output: &OutputFacts) {
    lines.add("triangles", grouped(output.triangles));
    let apart = output.vertices != output.positions;
    let at = if apart { format!(" at {} positions", grouped(output.positions)) } else { String::new() };
    lines.add("vertices", grouped(output.vertices) + &at);
}

fn soundness(lines: &mut Lines, valid: &Valid) {
    let counts = &valid.counts;
    lines.add(
        "closed",
        if counts.closed { "yes".into() } else { no(&[(counts.boundary_loops, "boundary loop")]) },
    );
    if !counts.manifold {
        let [edges, vertices] = [counts.non_manifold_edges, counts.non_manifold_vertices];
        lines.add(
            "manifold",
            no(&[(edges, "edge of three triangles or more"), (vertices, "vertex of several fans")]),
        );
    }
    if !counts.oriented {
        lines.add("oriented", no(&[(counts.inconsistent_edges, "edge of opposite winding")]));
    }
}

/// `no: 2 edges of this, 1 vertex of that`.
fn no(why: &[(u64, &str)]) -> String {
    let counted = why.iter().filter(|(count, _)| *count > 0).map(|(count, what)| plural(*count, what));
    let counted: Vec<_> = counted.collect();
    if counted.is_empty() { "no".to_owned() } else { format!("no: {}", counted.join(", ")) }
}

/// `1 edge of this`, `2 edges of this`, `2 vertices of that`.
fn plural(count: u64, what: &str) -> String {
    let (noun, rest) =
        what.split_once(" of ").map_or((what, String::new()), |(n, rest)| (n, format!(" of {rest}")));
    let noun = match (count, noun.strip_suffix("ex")) {
        (1, _) => noun.to_owned(),
        (_, Some(stem)) => format!("{stem}ices"),
        (_, None) => format!("{noun}s"),
    };
    format!("{} {noun}{rest}", grouped(count))
}

/// Every other count that should be zero and is not.
fn oddities(lines: &mut Lines, valid: &Valid) {
    let counts = &valid.counts;
    let named = [
        (counts.boundary_edges, "boundary edge"),
        (counts.t_junctions, "T-junction"),
        (counts.duplicate_faces, "repeated triangle"),
        (counts.collapsed_faces, "collapsed triangle"),
        (counts.zero_area_faces, "triangle of no area"),
        (counts.unused_vertices, "unused vertex"),
    ];
    for (count, what) in named.into_iter().filter(|(count, _)| *count > 0) {
        lines.add("", plural(count, what));
    }
    let other = &valid.other;
    if counts.boundary_edges != other.counts.boundary_edges {
        let edges = plural(other.counts.boundary_edges, "boundary edge");
        lines.add("", format!("{edges} where vertices meet by {}", other.topology));
    }
    lines.add("components", grouped(counts.components));
}

fn certified(found: &Found) -> String {
    let number = |pointer: &str| found.certificate.pointer(pointer).and_then(serde_json::Value::as_f64);
    let text = |pointer: &str| found.certificate.pointer(pointer).and_then(serde_json::Value::as_str);
    let bound = match (number("/bound/at_least"), number("/bound/at_most"), text("/bound/evidence")) {
        (Some(least), Some(most), Some(evidence)) => {
            format!("between {} and {} ({evidence})", short(least, Toward::Down), short(most, Toward::Up))
        }
        _ => "says no bound".to_owned(),
    };
    if found.differs.is_empty() {
        bound
    } else {
        format!("{bound}, but of another shape: {}", found.differs.join(", "))
    }
}

pub(crate) fn bound(facts: &BoundFacts) -> String {
    let least = short(facts.at_least, Toward::Down);
    match facts.at_most {
        Some(most) => format!("between {least} and {} ({})", short(most, Toward::Up), facts.evidence),
        None => format!("at least {least} ({})", facts.evidence),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn counts_in_words() {
        assert_eq!(plural(1, "edge of three triangles or more"), "1 edge of three triangles or more");
        assert_eq!(plural(2_000, "vertex of several fans"), "2,000 vertices of several fans");
        assert_eq!(no(&[(6, "boundary loop")]), "no: 6 boundary loops");
        assert_eq!(no(&[(0, "boundary loop")]), "no");
    }
}
