//! `Construction`: how a field was put together from solids whose surfaces are known in closed form.
//!
//! Shapes and combinations keep it, everything else drops it: a field that has none is an operand by itself. What it
//! describes is the set of points where the field is negative, but for the rounding of placements and for points on
//! surfaces that coincide.
use super::affine::Affine3;
use super::field::Field;
use super::shapes::Contours;
use std::sync::Arc;

/// A solid as a combination of others. Clones share their parts.
#[derive(Clone, Debug)]
pub struct Construction {
    node: Arc<ConstructionNode>,
    /// The nodes on the longest way down.
    depth: u32,
    /// The shapes at the ends of all ways down.
    n_solids: u64,
}

/// What a [`Construction`] is made of.
#[derive(Clone, Debug)]
pub enum ConstructionNode {
    /// A shape of which the numbers are known.
    Solid(SolidForm),
    /// A plane shape, without ends along z.
    Planar(PlanarForm),
    /// What a map makes of a solid: its point `p` goes to `map.at(p)`.
    Placed(Affine3, Construction),
    /// All points of any of them.
    Union(Arc<[Construction]>),
    /// The points that all of them have.
    Intersection(Arc<[Construction]>),
    /// All other points.
    Complement(Construction),
    /// A field about which nothing of the kind is known.
    Other(Arc<Field>),
}

/// A solid in its own coordinates.
#[derive(Clone, Debug)]
pub enum SolidForm {
    /// The box of these half sizes around the origin.
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
    /// A cone around z, from minus `half` to `half`; a cylinder where both radii are the same.
    Cone {
        /// The radius at the low end; one of both may be 0.
        bottom: f64,
        /// The radius at the high end.
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
    /// A plane shape between two heights.
    Extruded {
        /// The plane shape.
        profile: PlanarForm,
        /// From minus this height to this height.
        half: f64,
    },
    /// A plane shape turned about its y axis, which becomes the z axis.
    Revolved {
        /// The plane shape.
        profile: PlanarForm,
        /// Where it is in the plane first.
        place: Option<Affine3>,
    },
    /// A plane shape between two heights, with a section that grows evenly about z.
    Tapered {
        /// The plane shape, which is the section at the lower end.
        profile: PlanarForm,
        /// Where it is in the plane first.
        place: Option<Affine3>,
        /// From minus this height to this height.
        half: f64,
        /// How many times as large the section is at the upper end; above 0.
        factor: f64,
    },
    /// A plane shape between two heights, with a section that turns about z with the height.
    Twisted {
        /// The plane shape, which is the section at the height 0.
        profile: PlanarForm,
        /// Where it is in the plane first.
        place: Option<Affine3>,
        /// The lower and the upper end.
        heights: [f64; 2],
        /// The turn from one height to the next whole one.
        radians: f64,
    },
    /// A screw thread about z without ends: at the angle θ its section is the profile, raised by θ / 2π of the pitch.
    Thread {
        /// The section.
        profile: ThreadProfile,
        /// It is wanted from minus this height to this height at least.
        half: f64,
    },
}

/// The section of a thread: a ridge that repeats along z, with flanks that fall by √3 of their height along z.
#[derive(Clone, Copy, Debug)]
pub struct ThreadProfile {
    /// The largest radius, if the ridge has a flat there.
    pub major: f64,
    /// The least radius, if there is a flat between two turns.
    pub minor: f64,
    /// The height of a turn.
    pub pitch: f64,
    /// Half of the ridge's height along z at the largest radius; below 0 where its flanks meet before.
    pub at_crest: f64,
    /// The same at the least radius; above half of the pitch where two turns meet before.
    pub at_root: f64,
}

impl ThreadProfile {
    /// Its corners for one turn, each the radius and the height, from below the middle of the ridge upwards; the first
    /// comes again a pitch higher.
    #[must_use]
    pub fn corners(&self) -> Vec<[f64; 2]> {
        // Defined by ISO 68-1: an angle of 60° between two flanks.
        let slope = 3.0_f64.sqrt();
        let mut all = match self.at_crest {
            far if far > 0.0 => vec![[self.major, -far], [self.major, far]],
            far => vec![[self.major + slope * far, 0.0]],
        };
        let middle = 0.5 * self.pitch;
        if self.at_root < middle {
            all.extend([[self.minor, self.at_root], [self.minor, self.pitch - self.at_root]]);
        } else {
            all.push([self.major - slope * (middle - self.at_crest), middle]);
        }
        all
    }
}

/// A shape of the plane.
#[derive(Clone, Debug)]
pub enum PlanarForm {
    /// A disc around the origin.
    Disc {
        /// Above 0.
        radius: f64,
    },
    /// All points of a rectangle around the origin, and those nearer than a radius to it.
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
    /// What contours enclose.
    Contours(Arc<Contours>),
}

/// Beyond this depth parts of one operation become parts of one node. Chosen: for chains of n operations that is copied n / 64
/// times.
const FLAT_DEPTH: u32 = 64;
/// What is deeper still has no construction. Chosen: what walks through it calls itself.
const MOST_DEPTH: u32 = 256;

impl Construction {
    pub(super) fn new(node: ConstructionNode) -> Option<Self> {
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

    pub(super) fn solid(form: SolidForm) -> Option<Self> {
        Self::new(ConstructionNode::Solid(form))
    }

    pub(super) fn planar(form: PlanarForm) -> Option<Self> {
        Self::new(ConstructionNode::Planar(form))
    }

    /// What it is made of.
    #[must_use]
    pub fn node(&self) -> &ConstructionNode {
        &self.node
    }

    /// How many shapes it combines; one that stands at several places counts at each.
    #[must_use]
    pub fn n_solids(&self) -> u64 {
        self.n_solids
    }

    /// A number that clones share, and that no other construction has as long as one of them lives.
    #[must_use]
    pub fn address(&self) -> usize {
        Arc::as_ptr(&self.node) as usize
    }

    /// That of a field, or the field itself as an operand.
    fn of(field: &Field) -> Option<Self> {
        let own = || Self::new(ConstructionNode::Other(Arc::new(field.clone())));
        field.construction().cloned().or_else(own)
    }

    /// All points of either. None where nothing is known of both.
    pub(super) fn union(a: &Field, b: &Field) -> Option<Self> {
        Self::joined([a, b], ConstructionNode::Union, |node| match node {
            ConstructionNode::Union(parts) => Some(parts),
            _ => None,
        })
    }

    /// The points that both have. None where nothing is known of both.
    pub(super) fn intersection(a: &Field, b: &Field) -> Option<Self> {
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

    /// What other solids have of it.
    pub(super) fn clipped(&self, others: Vec<Self>) -> Option<Self> {
        let all: Vec<Self> = std::iter::once(self.clone()).chain(others).collect();
        Self::new(ConstructionNode::Intersection(all.into()))
    }

    /// All other points.
    pub(super) fn complement(&self) -> Option<Self> {
        match self.node() {
            ConstructionNode::Complement(below) => Some(below.clone()),
            _ => Self::new(ConstructionNode::Complement(self.clone())),
        }
    }

    /// Whether some part of it is a field by itself.
    #[must_use]
    pub fn has_other(&self) -> bool {
        self.has(&|node| matches!(node, ConstructionNode::Other(_)))
    }

    /// Whether it or something that it is made of is of a kind.
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

    /// The same under a further map. None where that flattens space by rounding.
    pub(super) fn placed(&self, rows: [[f64; 4]; 3]) -> Option<Self> {
        let map = Affine3::new(rows).ok()?;
        if map == Affine3::IDENTITY {
            return Some(self.clone());
        }
        Self::new(ConstructionNode::Placed(map, self.clone()))
    }

    /// What is left of the plane shape between two heights, `half` above 0 and below. None for what is no plane shape.
    pub(super) fn extruded(&self, half: f64) -> Option<Self> {
        self.map_planar(None, &|form, place| {
            let solid = Self::solid(SolidForm::Extruded { profile: form.clone(), half })?;
            match place {
                Some(map) => Self::new(ConstructionNode::Placed(map, solid)),
                None => Some(solid),
            }
        })
    }

    /// The plane shape turned about its y axis. None for what is no plane shape.
    pub(super) fn revolved(&self) -> Option<Self> {
        self.map_planar(None, &|form, place| {
            Self::solid(SolidForm::Revolved { profile: form.clone(), place })
        })
    }

    /// The same combination of what is made of each plane shape and its place. Heights of places are left out: a plane
    /// shape has none.
    pub(super) fn map_planar(&self, place: Option<Affine3>, make: &PlanarMap) -> Option<Self> {
        let each = |parts: &[Self]| -> Option<Arc<[Self]>> {
            parts.iter().map(|part| part.map_planar(place, make)).collect()
        };
        match self.node() {
            ConstructionNode::Planar(form) => make(form, place),
            ConstructionNode::Placed(map, below) => {
                let map = flat_map(map)?;
                let place = match place {
                    Some(outer) => flat_map(&outer.after(&map).ok()?)?,
                    None => map,
                };
                below.map_planar(Some(place), make)
            }
            ConstructionNode::Union(parts) => Self::new(ConstructionNode::Union(each(parts)?)),
            ConstructionNode::Intersection(parts) => Self::new(ConstructionNode::Intersection(each(parts)?)),
            ConstructionNode::Complement(below) => below.map_planar(place, make)?.complement(),
            ConstructionNode::Solid(_) | ConstructionNode::Other(_) => None,
        }
    }
}

/// Makes a solid of a plane shape and its place.
pub(super) type PlanarMap<'a> = dyn Fn(&PlanarForm, Option<Affine3>) -> Option<Construction> + 'a;

/// A map as it acts on shapes without ends along z, with heights left as they are. None where it turns them out of the
/// plane.
fn flat_map(map: &Affine3) -> Option<Affine3> {
    let [x, y, z] = map.rows();
    let keeps_axis = x[2] == 0.0 && y[2] == 0.0 && z[0] == 0.0 && z[1] == 0.0;
    let rows = [x, y, [0.0, 0.0, 1.0, 0.0]];
    if keeps_axis { Affine3::new(rows).ok() } else { None }
}
