//! `Construction`: how a field was built from solids whose surfaces are known in closed form.
//!
//! Shapes and combinations keep it, all other operations drop it: a field without one is an operand by
//! itself. It describes the set of points where the field is negative, except for the rounding of placements
//! and for points on surfaces that coincide.
use super::Field;
use crate::implicit::Affine3;
use crate::implicit::shapes::Contours;
use std::sync::Arc;

/// A solid as a combination of other solids. Clones share their parts.
#[derive(Clone, Debug)]
pub struct Construction {
    node: Arc<ConstructionNode>,
    /// The number of nodes on the longest path to a leaf.
    depth: u32,
    /// The number of shapes at the ends of all paths.
    n_solids: u64,
}

/// A node of a [`Construction`].
#[derive(Clone, Debug)]
pub enum ConstructionNode {
    /// A shape in closed form.
    Solid(SolidForm),
    /// A planar shape, unbounded along z.
    Planar(PlanarForm),
    /// The image of a solid under a map: its point `p` goes to `map.at(p)`.
    Placed(Affine3, Construction),
    /// The points in any of them.
    Union(Arc<[Construction]>),
    /// The points in all of them.
    Intersection(Arc<[Construction]>),
    /// All points outside of it.
    Complement(Construction),
    /// A field without a construction.
    Other(Arc<Field>),
}

/// A solid in its own coordinates.
#[derive(Clone, Debug)]
pub enum SolidForm {
    /// The box with these half sizes around the origin.
    Cuboid {
        /// Half of its sizes, above 0.
        half: [f64; 3],
    },
    /// All points nearer than the radius to a box around the origin.
    RoundedCuboid {
        /// Half of the sizes of that box, 0 or above.
        half: [f64; 3],
        /// Above 0.
        radius: f64,
    },
    /// All points with `normal · p < offset`.
    HalfSpace {
        /// A unit vector, rounded.
        normal: [f64; 3],
        /// The height of the plane along it.
        offset: f64,
    },
    /// A cone around z, from minus `half` to `half`; a cylinder if both radii are equal.
    Cone {
        /// The radius at the lower end; one of the two may be 0.
        bottom: f64,
        /// The radius at the upper end.
        top: f64,
        /// Half of the height.
        half: f64,
    },
    /// A ball around the origin.
    Sphere {
        /// Above 0.
        radius: f64,
    },
    /// All points nearer than a radius to a circle around z, in the plane z = 0.
    Torus {
        /// The radius of the circle.
        major: f64,
        /// The radius of the tube.
        minor: f64,
    },
    /// All points nearer than a radius to the segment between two points.
    Capsule {
        /// The points.
        ends: [[f64; 3]; 2],
        /// Above 0.
        radius: f64,
    },
    /// A planar shape between two heights.
    Extruded {
        /// The planar shape.
        profile: PlanarForm,
        /// From minus this height to this height.
        half: f64,
    },
    /// A planar shape revolved about its y axis, which becomes the z axis.
    Revolved {
        /// The planar shape.
        profile: PlanarForm,
        /// Its placement in the plane before revolving.
        place: Option<Affine3>,
    },
    /// A planar shape between two heights, scaled about z linearly with the height.
    Tapered {
        /// The planar shape, which is the section at the lower end.
        profile: PlanarForm,
        /// Its placement in the plane before tapering.
        place: Option<Affine3>,
        /// From minus this height to this height.
        half: f64,
        /// The scale of the section at the upper end; above 0.
        factor: f64,
    },
    /// A planar shape between two heights, turned about z in proportion to the height.
    Twisted {
        /// The planar shape, which is the section at height 0.
        profile: PlanarForm,
        /// Its placement in the plane before twisting.
        place: Option<Affine3>,
        /// The lower and the upper end.
        heights: [f64; 2],
        /// The angle per unit of height.
        radians: f64,
    },
    /// A screw thread about z without ends: at the angle θ its section is the profile, raised by θ / 2π of
    /// the pitch.
    Thread {
        /// The section.
        profile: ThreadProfile,
        /// The thread is needed at least from minus this height to this height.
        half: f64,
    },
}

/// The section of a thread: a ridge that repeats along z, with flanks that fall by √3 of their height along
/// z.
#[derive(Clone, Copy, Debug)]
pub struct ThreadProfile {
    /// The largest radius, if the ridge has a flat there.
    pub major: f64,
    /// The smallest radius, if there is a flat between two turns.
    pub minor: f64,
    /// The height of a turn.
    pub pitch: f64,
    /// Half of the ridge's height along z at the largest radius; negative if its flanks meet below that
    /// radius.
    pub at_crest: f64,
    /// The same at the smallest radius; above half of the pitch if two turns meet above that radius.
    pub at_root: f64,
}

impl ThreadProfile {
    /// Its corners for one turn, each as radius and height, from below the middle of the ridge upwards; the
    /// first corner repeats a pitch higher.
    #[must_use]
    pub fn corners(&self) -> Vec<[f64; 2]> {
        // Defined by ISO 68-1: an angle of 60° between two flanks.
        let slope = 3.0_f64.sqrt();
        let mut corners = match self.at_crest {
            half_crest if half_crest > 0.0 => vec![[self.major, -half_crest], [self.major, half_crest]],
            half_crest => vec![[self.major + slope * half_crest, 0.0]],
        };
        let middle = 0.5 * self.pitch;
        if self.at_root < middle {
            corners.extend([[self.minor, self.at_root], [self.minor, self.pitch - self.at_root]]);
        } else {
            corners.push([self.major - slope * (middle - self.at_crest), middle]);
        }
        corners
    }
}

/// A planar shape.
#[derive(Clone, Debug)]
pub enum PlanarForm {
    /// A disc around the origin.
    Disc {
        /// Above 0.
        radius: f64,
    },
    /// All points of a rectangle around the origin, and those nearer to it than a radius.
    Rectangle {
        /// Half of its sizes, without the radius.
        half: [f64; 2],
        /// 0 or above.
        radius: f64,
    },
    /// All points nearer than a radius to the segment between two points.
    Segment {
        /// The points.
        ends: [[f64; 2]; 2],
        /// Above 0.
        radius: f64,
    },
    /// The region that contours enclose.
    Contours(Arc<Contours>),
}

/// Beyond this depth the parts of nested operations become parts of one node. Chosen: a chain of n operations
/// is then copied n / 64 times.
const FLAT_DEPTH: u32 = 64;
/// A deeper combination has no construction. Chosen: walks through constructions recurse, and the stack has
/// room for this many calls.
const MOST_DEPTH: u32 = 256;

impl Construction {
    pub(in crate::implicit) fn new(node: ConstructionNode) -> Option<Self> {
        use ConstructionNode::{Complement, Intersection, Other, Placed, Planar, Solid, Union};
        let below = match &node {
            Solid(_) | Planar(_) | Other(_) => 0,
            Placed(_, below) | Complement(below) => below.depth,
            Union(parts) | Intersection(parts) => parts.iter().fold(0, |most, part| part.depth.max(most)),
        };
        let n_solids = match &node {
            Solid(_) | Planar(_) | Other(_) => 1,
            Placed(_, below) | Complement(below) => below.n_solids,
            Union(parts) | Intersection(parts) => {
                parts.iter().fold(0, |n: u64, part| n.saturating_add(part.n_solids))
            }
        };
        (below < MOST_DEPTH).then(|| Self { node: Arc::new(node), depth: below + 1, n_solids })
    }

    pub(in crate::implicit) fn solid(form: SolidForm) -> Option<Self> {
        Self::new(ConstructionNode::Solid(form))
    }

    pub(in crate::implicit) fn planar(form: PlanarForm) -> Option<Self> {
        Self::new(ConstructionNode::Planar(form))
    }

    /// Its root node.
    #[must_use]
    pub fn node(&self) -> &ConstructionNode {
        &self.node
    }

    /// The number of shapes that it combines, with repetitions.
    #[must_use]
    pub fn n_solids(&self) -> u64 {
        self.n_solids
    }

    /// An identifier that clones share, and that no other construction has while one of them lives.
    #[must_use]
    pub fn address(&self) -> usize {
        Arc::as_ptr(&self.node) as usize
    }

    /// The construction of a field, or the field itself as an operand.
    fn of(field: &Field) -> Option<Self> {
        let operand = || Self::new(ConstructionNode::Other(Arc::new(field.clone())));
        field.construction().cloned().or_else(operand)
    }

    /// The points in either. None if both are operands without a construction.
    pub(in crate::implicit) fn union(a: &Field, b: &Field) -> Option<Self> {
        Self::joined([a, b], ConstructionNode::Union, |node| match node {
            ConstructionNode::Union(parts) => Some(parts),
            _ => None,
        })
    }

    /// The points in both. None if both are operands without a construction.
    pub(in crate::implicit) fn intersection(a: &Field, b: &Field) -> Option<Self> {
        Self::joined([a, b], ConstructionNode::Intersection, |node| match node {
            ConstructionNode::Intersection(parts) => Some(parts),
            _ => None,
        })
    }

    fn joined(
        fields: [&Field; 2],
        join: fn(Arc<[Self]>) -> ConstructionNode,
        parts_of: fn(&ConstructionNode) -> Option<&Arc<[Self]>>,
    ) -> Option<Self> {
        fields.iter().find(|field| field.construction().is_some())?;
        let [a, b] = [Self::of(fields[0])?, Self::of(fields[1])?];
        if a.depth.max(b.depth) < FLAT_DEPTH {
            return Self::new(join(Arc::new([a, b])));
        }
        // From the last to the first, so that the first is on top.
        let (mut todo, mut flat) = (vec![b, a], Vec::new());
        while let Some(next) = todo.pop() {
            match parts_of(&next.node) {
                Some(parts) => todo.extend(parts.iter().rev().cloned()),
                None => flat.push(next),
            }
        }
        Self::new(join(flat.into()))
    }

    /// Its intersection with other solids.
    pub(in crate::implicit) fn clipped(&self, others: Vec<Self>) -> Option<Self> {
        let parts: Vec<Self> = std::iter::once(self.clone()).chain(others).collect();
        Self::new(ConstructionNode::Intersection(parts.into()))
    }

    /// All points outside of it.
    pub(in crate::implicit) fn complement(&self) -> Option<Self> {
        match self.node() {
            ConstructionNode::Complement(below) => Some(below.clone()),
            _ => Self::new(ConstructionNode::Complement(self.clone())),
        }
    }

    /// Whether some part of it is a field without a construction.
    #[must_use]
    pub fn has_other(&self) -> bool {
        self.has(&|node| matches!(node, ConstructionNode::Other(_)))
    }

    /// Whether it or one of its parts is of a kind.
    pub fn has(&self, is_of_kind: &impl Fn(&ConstructionNode) -> bool) -> bool {
        is_of_kind(self.node())
            || match self.node() {
                ConstructionNode::Placed(_, below) | ConstructionNode::Complement(below) => {
                    below.has(is_of_kind)
                }
                ConstructionNode::Union(parts) | ConstructionNode::Intersection(parts) => {
                    parts.iter().any(|part| part.has(is_of_kind))
                }
                ConstructionNode::Solid(_) | ConstructionNode::Planar(_) | ConstructionNode::Other(_) => {
                    false
                }
            }
    }

    /// The same under a further map. None if rounding makes that map flatten space.
    pub(in crate::implicit) fn placed(&self, rows: [[f64; 4]; 3]) -> Option<Self> {
        let map = Affine3::new(rows).ok()?;
        if map == Affine3::IDENTITY {
            return Some(self.clone());
        }
        Self::new(ConstructionNode::Placed(map, self.clone()))
    }

    /// The planar shape between the heights `-half` and `half`. None if this is not a planar shape.
    pub(in crate::implicit) fn extruded(&self, half: f64) -> Option<Self> {
        self.map_planar(None, &|form, placement| {
            let solid = Self::solid(SolidForm::Extruded { profile: form.clone(), half })?;
            match placement {
                Some(map) => Self::new(ConstructionNode::Placed(map, solid)),
                None => Some(solid),
            }
        })
    }

    /// The planar shape revolved about its y axis. None if this is not a planar shape.
    pub(in crate::implicit) fn revolved(&self) -> Option<Self> {
        self.map_planar(None, &|form, placement| {
            Self::solid(SolidForm::Revolved { profile: form.clone(), place: placement })
        })
    }

    /// The same combination, with each planar shape and its placement replaced by a solid from `make`.
    /// Heights in placements are dropped: a planar shape has none.
    pub(in crate::implicit) fn map_planar(
        &self,
        placement: Option<Affine3>,
        make: &PlanarMap,
    ) -> Option<Self> {
        let each = |parts: &[Self]| -> Option<Arc<[Self]>> {
            parts.iter().map(|part| part.map_planar(placement, make)).collect()
        };
        match self.node() {
            ConstructionNode::Planar(form) => make(form, placement),
            ConstructionNode::Placed(map, below) => {
                let map = flat_map(map)?;
                let placement = match placement {
                    Some(outer) => flat_map(&outer.after(&map).ok()?)?,
                    None => map,
                };
                below.map_planar(Some(placement), make)
            }
            ConstructionNode::Union(parts) => Self::new(ConstructionNode::Union(each(parts)?)),
            ConstructionNode::Intersection(parts) => Self::new(ConstructionNode::Intersection(each(parts)?)),
            ConstructionNode::Complement(below) => below.map_planar(placement, make)?.complement(),
            ConstructionNode::Solid(_) | ConstructionNode::Other(_) => None,
        }
    }
}

/// Builds a solid from a planar shape and its placement.
pub(in crate::implicit) type PlanarMap<'a> =
    dyn Fn(&PlanarForm, Option<Affine3>) -> Option<Construction> + 'a;

/// The effect of a map on shapes that are unbounded along z, with heights unchanged. None if it tilts the z
/// axis.
fn flat_map(map: &Affine3) -> Option<Affine3> {
    let [x, y, z] = map.rows();
    let keeps_axis = x[2] == 0.0 && y[2] == 0.0 && z[0] == 0.0 && z[1] == 0.0;
    let rows = [x, y, [0.0, 0.0, 1.0, 0.0]];
    if keeps_axis { Affine3::new(rows).ok() } else { None }
}
