//! The [`Construction`] of offsets, tapers and twists. Each is applied to the parts one by one, because that
//! is its effect on the minima and maxima of the parts' fields.
use super::affine::Affine3;
use super::construction::{Construction, ConstructionNode, PlanarForm, SolidForm};
use super::distance::DistanceQuality;
use super::shapes::Contours;

/// The most sides of contours that are offset side by side. Chosen: each side becomes a shape of its own.
const MOST_SIDES: usize = 256;

impl Construction {
    /// The points where the field is below `by`. None if some part has no such surface in closed form.
    ///
    /// Grown intersections and shrunk complements are refused: outside, their fields may be less than the
    /// distance.
    pub(super) fn offset(&self, by: f64) -> Option<Self> {
        let each = |parts: &[Self]| parts.iter().map(|part| part.offset(by)).collect::<Option<Vec<_>>>();
        match self.node() {
            ConstructionNode::Planar(form) => planar_offset(form, by),
            ConstructionNode::Solid(form) => Self::solid(solid_offset(form, by)?),
            ConstructionNode::Placed(map, below) => {
                let [x, y, z] = map.rows().map(|row| row[0]);
                let scale = (x * x + y * y + z * z).sqrt();
                // Other scales would be rounded twice.
                if scale != 1.0 {
                    return None;
                }
                Self::new(ConstructionNode::Placed(*map, below.offset(by)?))
            }
            // Grown contours are a union too, whose value is less deep than theirs.
            ConstructionNode::Union(parts) if by < 0.0 && parts.iter().any(Self::is_contours) => None,
            ConstructionNode::Union(parts) => Self::new(ConstructionNode::Union(each(parts)?.into())),
            ConstructionNode::Intersection(parts) if by < 0.0 => {
                Self::new(ConstructionNode::Intersection(each(parts)?.into()))
            }
            ConstructionNode::Complement(below) if by > 0.0 => below.offset(-by)?.complement(),
            // A part that is grown below a complement may have been shrunk before, and is sharp when it is
            // grown again.
            ConstructionNode::Complement(_)
            | ConstructionNode::Intersection(_)
            | ConstructionNode::Other(_) => None,
        }
    }

    fn is_contours(&self) -> bool {
        matches!(self.node(), ConstructionNode::Planar(PlanarForm::Contours(_)))
    }

    /// A planar shape between the heights `-half` and `half`, scaled by `factor` at the upper one.
    pub(super) fn tapered(&self, factor: f64, half: f64) -> Option<Self> {
        self.map_planar(None, &|form, place| {
            Self::solid(SolidForm::Tapered { profile: form.clone(), place, half, factor })
        })
    }

    /// Turned about z by `radians` per unit of height. None if this is not a combination of upright prisms.
    pub(super) fn twisted(&self, radians: f64) -> Option<Self> {
        self.map_prisms(&Affine3::IDENTITY, radians)
    }

    fn map_prisms(&self, placement: &Affine3, radians: f64) -> Option<Self> {
        let each = |parts: &[Self]| {
            parts.iter().map(|part| part.map_prisms(placement, radians)).collect::<Option<Vec<_>>>()
        };
        match self.node() {
            ConstructionNode::Solid(form) => {
                let (profile, half) = prism(form)?;
                let [x, y, z] = placement.rows();
                let is_upright = [x[2], y[2], z[0], z[1]] == [0.0; 4];
                if !is_upright {
                    return None;
                }
                let flat = Affine3::new([x, y, [0.0, 0.0, 1.0, 0.0]]).ok()?;
                let reach = z[2].abs() * half;
                let heights = [z[3] - reach, z[3] + reach];
                let placement = if flat == Affine3::IDENTITY { None } else { Some(flat) };
                Self::solid(SolidForm::Twisted { profile, place: placement, heights, radians })
            }
            ConstructionNode::Placed(map, below) => below.map_prisms(&placement.after(map).ok()?, radians),
            ConstructionNode::Union(parts) => Self::new(ConstructionNode::Union(each(parts)?.into())),
            ConstructionNode::Intersection(parts) => {
                Self::new(ConstructionNode::Intersection(each(parts)?.into()))
            }
            ConstructionNode::Complement(below) => below.map_prisms(placement, radians)?.complement(),
            ConstructionNode::Planar(_) | ConstructionNode::Other(_) => None,
        }
    }
}

/// The section and half of the height of a solid with the same section at all heights.
fn prism(form: &SolidForm) -> Option<(PlanarForm, f64)> {
    match form {
        SolidForm::Extruded { profile, half } => Some((profile.clone(), *half)),
        SolidForm::Cuboid { half: [x, y, z] } => {
            Some((PlanarForm::Rectangle { half: [*x, *y], radius: 0.0 }, *z))
        }
        SolidForm::Cone { bottom, top, half } if bottom == top => {
            Some((PlanarForm::Disc { radius: *bottom }, *half))
        }
        _ => None,
    }
}

fn above_zero(x: f64) -> Option<f64> {
    (x > 0.0).then_some(x)
}

/// Half sizes and a radius around them, for the offset of a rectangle or a box.
fn rounded_offset<const N: usize>(half: [f64; N], radius: f64, by: f64) -> Option<([f64; N], f64)> {
    let radius = radius + by;
    if radius > 0.0 {
        return Some((half, radius));
    }
    let half = half.map(|x| x + radius);
    half.iter().all(|x| *x > 0.0).then_some((half, 0.0))
}

fn solid_offset(form: &SolidForm, by: f64) -> Option<SolidForm> {
    Some(match form {
        SolidForm::Cuboid { half } => cuboid(rounded_offset(*half, 0.0, by)?),
        SolidForm::RoundedCuboid { half, radius } => cuboid(rounded_offset(*half, *radius, by)?),
        SolidForm::HalfSpace { normal, offset } => {
            SolidForm::HalfSpace { normal: *normal, offset: offset + by }
        }
        SolidForm::Sphere { radius } => SolidForm::Sphere { radius: above_zero(radius + by)? },
        SolidForm::Torus { major, minor } => {
            SolidForm::Torus { major: *major, minor: above_zero(minor + by)? }
        }
        SolidForm::Capsule { ends, radius } => {
            SolidForm::Capsule { ends: *ends, radius: above_zero(radius + by)? }
        }
        // A cylinder that shrinks keeps its sharp edges; if it grows, they become round.
        SolidForm::Cone { bottom, top, half } if bottom == top && by < 0.0 => {
            let radius = above_zero(bottom + by)?;
            SolidForm::Cone { bottom: radius, top: radius, half: above_zero(half + by)? }
        }
        SolidForm::Cone { .. }
        | SolidForm::Extruded { .. }
        | SolidForm::Revolved { .. }
        | SolidForm::Tapered { .. }
        | SolidForm::Twisted { .. }
        | SolidForm::Thread { .. } => return None,
    })
}

fn cuboid((half, radius): ([f64; 3], f64)) -> SolidForm {
    if radius > 0.0 { SolidForm::RoundedCuboid { half, radius } } else { SolidForm::Cuboid { half } }
}

fn planar_offset(form: &PlanarForm, by: f64) -> Option<Construction> {
    Construction::planar(match form {
        PlanarForm::Disc { radius } => PlanarForm::Disc { radius: above_zero(radius + by)? },
        PlanarForm::Segment { ends, radius } => {
            PlanarForm::Segment { ends: *ends, radius: above_zero(radius + by)? }
        }
        PlanarForm::Rectangle { half, radius } => {
            let (half, radius) = rounded_offset(*half, *radius, by)?;
            PlanarForm::Rectangle { half, radius }
        }
        PlanarForm::Contours(contours) => return contours_offset(contours, form, by),
    })
}

/// The region that contours enclose, with or without all points within a distance of one of their sides.
fn contours_offset(contours: &Contours, form: &PlanarForm, by: f64) -> Option<Construction> {
    let distance = contours.distance();
    let quality = if by > 0.0 { distance.outside } else { distance.inside };
    let loops = contours.loops()?;
    let n_sides: usize = loops.iter().map(Vec::len).sum();
    // Only an exact distance, less `by`, is negative in just this region.
    if quality != DistanceQuality::Exact || n_sides > MOST_SIDES {
        return None;
    }
    let side = |corners: &[[f64; 2]], k: usize| {
        let ends = [corners[k], corners[(k + 1) % corners.len()]];
        Construction::planar(PlanarForm::Segment { ends, radius: by.abs() })
    };
    let mut parts = vec![Construction::planar(form.clone())?];
    for corners in &loops {
        for k in 0..corners.len() {
            let capsule = side(corners, k)?;
            parts.push(if by > 0.0 { capsule } else { capsule.complement()? });
        }
    }
    Construction::new(if by > 0.0 {
        ConstructionNode::Union(parts.into())
    } else {
        ConstructionNode::Intersection(parts.into())
    })
}
