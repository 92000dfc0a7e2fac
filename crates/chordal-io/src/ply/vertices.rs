//! The vertices of a PLY file: reads properties into streams.
use super::body::PlyBody;
use super::header::{PlyElement, PlyPropertyType, PlyScalar};
use crate::assemble::checked_position_ids;
use crate::grow::{push, push_many, with_room};
use crate::warnings::Warnings;
use crate::{FileLocation, Limits, ReadError};
use chordal::Job;
use chordal::explicit::{Attribute, Domain, Semantic};

/// The property names of the known streams.
const TEXCOORDS: [[&str; 2]; 5] = [
    ["s", "t"],
    ["u", "v"],
    ["texture_u", "texture_v"],
    ["texture_s", "texture_t"],
    ["texcoord_u", "texcoord_v"],
];
const COLORS: [[&str; 4]; 3] = [
    ["red", "green", "blue", "alpha"],
    ["diffuse_red", "diffuse_green", "diffuse_blue", "diffuse_alpha"],
    ["r", "g", "b", "a"],
];
const NORMAL: [&str; 3] = ["nx", "ny", "nz"];
const POSITION: [&str; 3] = ["x", "y", "z"];
/// The property that links vertices at one position; only this library writes it.
pub(super) const POSITION_ID: &str = "position_id";

/// The destination of a value.
#[derive(Clone, Copy, Debug)]
enum PlyValueTarget {
    Position(usize),
    PositionId,
    /// A stream, a component, and the divisor of the value.
    Stream(usize, usize, f64),
    Skip,
}

/// The data of the vertices.
#[derive(Debug, Default)]
pub(super) struct PlyVertices {
    pub(super) positions: Vec<[f64; 3]>,
    pub(super) position_id: Option<Vec<u32>>,
    pub(super) attributes: Vec<Attribute>,
}

struct PlyVertexLayout {
    targets: Vec<PlyValueTarget>,
    streams: Vec<Attribute>,
    has_id: bool,
}

impl PlyVertexLayout {
    fn from_element(element: &PlyElement, warnings: &mut Warnings) -> Result<Self, ReadError> {
        let mut plan = Self {
            targets: vec![PlyValueTarget::Skip; element.properties.len()],
            streams: Vec::new(),
            has_id: false,
        };
        let place = FileLocation::Line(element.line);
        for (k, axis) in POSITION.iter().enumerate() {
            match find(element, axis) {
                Some((i, scalar)) if !matches!(scalar, PlyScalar::Opaque(_)) => {
                    plan.targets[i] = PlyValueTarget::Position(k)
                }
                _ => {
                    let message = format!("element 'vertex' has no number '{axis}'");
                    return Err(ReadError::new("no-position", place, message));
                }
            }
        }
        plan.stream(element, Semantic::Normal, &NORMAL);
        for (set, names) in TEXCOORDS.iter().filter(|names| has(element, &names[..])).enumerate() {
            plan.stream(element, Semantic::TexCoord(set as u32), names);
        }
        for (set, names) in COLORS.iter().filter(|names| has(element, &names[..3])).enumerate() {
            let width = if has(element, &names[..]) { 4 } else { 3 };
            plan.stream(element, Semantic::Color(set as u32), &names[..width]);
        }
        plan.read_custom(element, warnings);
        Ok(plan)
    }

    /// Adds a stream of the properties of these names, if all of them are present.
    fn stream(&mut self, element: &PlyElement, semantic: Semantic, names: &[&str]) {
        if !has(element, names) {
            return;
        }
        let is_color = matches!(semantic, Semantic::Color(_));
        for (k, name) in names.iter().enumerate() {
            let Some((i, scalar)) = find(element, name) else { continue };
            let divisor = match scalar {
                PlyScalar::U8 if is_color => 255.0,
                PlyScalar::U16 if is_color => 65535.0,
                _ => 1.0,
            };
            self.targets[i] = PlyValueTarget::Stream(self.streams.len(), k, divisor);
        }
        let domain = Domain::Vertex;
        self.streams.push(Attribute { semantic, domain, width: names.len(), values: Vec::new() });
    }

    /// Adds every other number as a separate stream; lists and types of unknown meaning are skipped.
    fn read_custom(&mut self, element: &PlyElement, warnings: &mut Warnings) {
        for (i, property) in element.properties.iter().enumerate() {
            if !matches!(self.targets[i], PlyValueTarget::Skip) {
                continue;
            }
            match property.shape {
                PlyPropertyType::One(PlyScalar::U32 | PlyScalar::I32) if property.name == POSITION_ID => {
                    self.targets[i] = PlyValueTarget::PositionId;
                    self.has_id = true;
                }
                PlyPropertyType::One(scalar) if !matches!(scalar, PlyScalar::Opaque(_)) => {
                    self.targets[i] = PlyValueTarget::Stream(self.streams.len(), 0, 1.0);
                    let semantic = Semantic::Custom(property.name.clone());
                    let domain = Domain::Vertex;
                    self.streams.push(Attribute { semantic, domain, width: 1, values: Vec::new() });
                }
                _ => warnings.count("vertex-property-skipped", || {
                    let message = format!(
                        "properties of vertices were skipped, '{}' first",
                        property.name.escape_default()
                    );
                    (FileLocation::Line(element.line), message)
                }),
            }
        }
    }
}

fn find(element: &PlyElement, name: &str) -> Option<(usize, PlyScalar)> {
    element.properties.iter().enumerate().find_map(|(i, p)| match p.shape {
        PlyPropertyType::One(scalar) if p.name == name => Some((i, scalar)),
        _ => None,
    })
}

fn has(element: &PlyElement, names: &[&str]) -> bool {
    names.iter().all(|name| find(element, name).is_some_and(|(_, s)| !matches!(s, PlyScalar::Opaque(_))))
}

impl PlyVertices {
    /// Reads all rows.
    pub(super) fn read(
        body: &mut PlyBody,
        element: &PlyElement,
        limits: &Limits,
        warnings: &mut Warnings,
    ) -> Result<Self, ReadError> {
        let PlyVertexLayout { targets, mut streams, has_id } =
            PlyVertexLayout::from_element(element, warnings)?;
        // `PlyBody::check_size` checked that the file has the bytes for all rows, so the memory is in
        // proportion.
        let n_rows = element.rows as usize;
        let mut positions: Vec<[f64; 3]> = with_room(n_rows)?;
        let mut ids: Vec<i64> = with_room(if has_id { n_rows } else { 0 })?;
        for stream in &mut streams {
            stream.values = with_room(n_rows * stream.width)?;
        }
        let mut store =
            |streams: &mut [Attribute], row: usize, target: PlyValueTarget, value: f64| match target {
                PlyValueTarget::PositionId => push(&mut ids, value as i64),
                PlyValueTarget::Stream(stream, k, divisor) => {
                    let Attribute { width, values, .. } = &mut streams[stream];
                    // By index, since the properties of a stream may be declared in any order.
                    values[row * *width + k] = value / divisor;
                    Ok(())
                }
                PlyValueTarget::Position(_) | PlyValueTarget::Skip => Ok(()),
            };
        let make_room = |streams: &mut [Attribute]| {
            streams.iter_mut().try_for_each(|s| push_many(&mut s.values, 0.0, s.width))
        };
        let axes = [0, 1, 2].map(|k| {
            let is_axis =
                |target: &PlyValueTarget| matches!(target, PlyValueTarget::Position(axis) if *axis == k);
            targets.iter().position(is_axis).unwrap_or_default()
        });
        let is_flat = element.properties.iter().all(|p| matches!(p.shape, PlyPropertyType::One(_)));
        let mut n_plain = 0;
        if is_flat {
            let job = Job::default().with_threads(limits.threads);
            n_plain = body.plain_rows(element, &job, |rows| {
                for (i, values) in rows.values.chunks_exact(targets.len()).take(rows.ends.len()).enumerate() {
                    let position = axes.map(|i| values[i]);
                    if !limits.drop_nonfinite && position.iter().any(|x| !x.is_finite()) {
                        // The loop below reads this row again, and reports where it is.
                        return Ok(i as u64);
                    }
                    make_room(&mut streams)?;
                    for (target, value) in targets.iter().zip(values) {
                        store(&mut streams, positions.len(), *target, *value)?;
                    }
                    push(&mut positions, position)?;
                }
                Ok(rows.ends.len() as u64)
            })?;
        }
        for row in n_plain..element.rows {
            body.start_row(element, row)?;
            make_room(&mut streams)?;
            let mut position = [0.0; 3];
            for (property, target) in element.properties.iter().zip(&targets) {
                let PlyPropertyType::One(scalar) = property.shape else {
                    body.skip(element, property.shape)?;
                    continue;
                };
                let value = body.number(element, scalar)?;
                match *target {
                    PlyValueTarget::Position(k) => position[k] = value,
                    target => store(&mut streams, row as usize, target, value)?,
                }
            }
            body.end_row(element)?;
            if let Some(k) = position.iter().position(|x| !x.is_finite())
                && !limits.drop_nonfinite
            {
                let message = format!("{} = {} is not finite", POSITION[k], position[k]);
                return Err(body.error(element, "not-finite", &message));
            }
            push(&mut positions, position)?;
        }
        let position_id = if has_id { checked_position_ids(&ids, &positions, warnings)? } else { None };
        Ok(Self { positions, position_id, attributes: streams })
    }
}
