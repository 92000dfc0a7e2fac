//! `Component`: the properties of each set of faces connected by edges, counted.
use super::connectivity::MeshConnectivity;
use super::edge_topology::{connected_faces, find_non_orientable};
use super::fans::{BoundaryKind, count_fans, walk_boundary};
use super::measure::{Measure, power_of_two_near};
use crate::explicit::{Mesh, Twin, next_in_face};
use crate::math::{Box3, greater};
use glam::DVec3;

/// The direction that the front of a component faces.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Facing {
    /// Away from the material: out of a solid, into a cavity.
    Outward,
    /// Into the material: the component is wound inside out.
    InsideOut,
    /// There are two sides, but the enclosed volume is zero up to rounding, or the component lies on the
    /// surface of another one.
    Undecided,
    /// There is no inside: an edge has only one face, or is not traversed equally often in both directions.
    NoInside,
}

impl Facing {
    /// The name in a report.
    #[must_use]
    pub fn as_str(self) -> &'static str {
        match self {
            Self::Outward => "outward",
            Self::InsideOut => "inside-out",
            Self::Undecided => "undecided",
            Self::NoInside => "no-inside",
        }
    }
}

/// A set of faces connected by edges.
#[derive(Clone, Debug, PartialEq)]
pub struct Component {
    /// Its lowest face.
    pub first_face: u32,
    /// The number of its faces.
    pub faces: u64,
    /// The number of its edges.
    pub edges: u64,
    /// The number of its positions; a position that it shares with another component counts in both.
    pub positions: u64,
    /// Edges with one face.
    pub boundary_edges: u64,
    /// Closed paths of boundary edges.
    pub boundary_loops: u64,
    /// Whether every edge has at least two faces.
    pub closed: bool,
    /// Whether no edge has more than two faces.
    pub edge_manifold: bool,
    /// Whether its faces at each position form one fan.
    pub vertex_manifold: bool,
    /// Whether the two faces of every edge with two are wound consistently.
    pub oriented: bool,
    /// Whether they could be wound consistently.
    pub orientable: bool,
    /// Euler characteristic: positions − edges + faces.
    pub euler: i64,
    /// Handles, with each boundary loop closed by a disc; `None` if the component is not manifold or not
    /// orientable.
    pub genus: Option<u64>,
    /// The bounding box of its corners.
    pub bounds: Box3,
    /// Its area, and the enclosed volume, which is meaningful if it has an inside.
    pub measure: Measure,
    /// The number of other components with an inside that enclose it; `None` if it has no inside or this
    /// is undecided.
    pub depth: Option<u32>,
    /// The number of the outermost component around it, which no other one encloses; `None` if there is none,
    /// or more than one.
    pub outermost: Option<u32>,
    /// The direction that its front faces.
    pub facing: Facing,
}

impl Component {
    /// Whether it is edge-manifold and vertex-manifold.
    #[must_use]
    pub fn manifold(&self) -> bool {
        self.edge_manifold && self.vertex_manifold
    }
}

/// The label of a face without a component.
pub(super) const NONE: u32 = u32::MAX;

/// The components before their facing is known.
pub(super) struct ComponentSet {
    pub components: Vec<Component>,
    /// The component of each face, or [`NONE`].
    pub labels: Vec<u32>,
    /// The sign of the volume of each component with an inside.
    pub signs: Vec<Option<i8>>,
}

impl ComponentSet {
    pub fn from_connectivity(surface: &MeshConnectivity) -> Self {
        let (labels, mut components) = label_components(surface);
        let inside = count_edges(surface, &labels, &mut components);
        count_positions(surface, &labels, &mut components);
        walk_boundary(&surface.twins, |h, ending| {
            components[labels[h as usize / 3] as usize].boundary_loops +=
                u64::from(ending == BoundaryKind::Loop);
        });
        // If all neighbours are wound alike, the search would find nothing.
        if components.iter().any(|component| !component.oriented) {
            find_non_orientable(surface, |face| {
                components[labels[face as usize] as usize].orientable = false
            });
        }
        let volumes = measure_components(surface.mesh, &labels, &mut components);
        for component in &mut components {
            component.closed = component.boundary_edges == 0;
            component.euler = component.positions as i64 - component.edges as i64 + component.faces as i64;
            // χ = 2 − 2·genus − loops for one component of an orientable surface with boundary.
            let twice_genus = 2 - component.euler - component.boundary_loops as i64;
            component.genus =
                (component.manifold() && component.orientable).then_some(twice_genus as u64 / 2);
        }
        // The sign of a volume means inside or outside only if the surface is closed, its
        // neighbours are wound alike, and each edge with three or more faces is run through as
        // often upwards as downwards.
        let signs: Vec<Option<i8>> = (0..components.len())
            .map(|i| (inside[i] && components[i].closed && components[i].oriented).then(|| volumes[i].sign()))
            .collect();
        Self { components, labels, signs }
    }
}

/// Labels each face with its component, or [`NONE`], and counts the faces of each component.
pub(super) fn label_components(surface: &MeshConnectivity) -> (Vec<u32>, Vec<Component>) {
    let mut sets = connected_faces(surface);
    let mut labels = vec![NONE; surface.n_faces() as usize];
    let mut components: Vec<Component> = Vec::new();
    for face in 0..surface.n_faces() {
        if surface.half_edges(face).is_none() {
            continue;
        }
        let root = sets.find(face);
        // The root of a set is its first face, so it comes first.
        if root == face {
            labels[face as usize] = components.len() as u32;
            components.push(empty(face));
        }
        let label = labels[root as usize];
        labels[face as usize] = label;
        components[label as usize].faces += 1;
    }
    (labels, components)
}

fn empty(first_face: u32) -> Component {
    Component {
        first_face,
        faces: 0,
        edges: 0,
        positions: 0,
        boundary_edges: 0,
        boundary_loops: 0,
        closed: false,
        edge_manifold: true,
        vertex_manifold: true,
        oriented: true,
        orientable: true,
        euler: 0,
        genus: None,
        bounds: Box3::EMPTY,
        measure: Measure { area: 0.0, signed_volume: 0.0 },
        depth: None,
        outermost: None,
        facing: Facing::NoInside,
    }
}

/// Counts the edges of each component. Returns whether its edges with three or more faces are traversed
/// equally often in both directions.
fn count_edges(surface: &MeshConnectivity, labels: &[u32], components: &mut [Component]) -> Vec<bool> {
    for h in 0..surface.twins.len() as u32 {
        let label = labels[h as usize / 3];
        if label == NONE {
            continue;
        }
        let component = &mut components[label as usize];
        match surface.twins.get(h) {
            // Counted at the lower of the two half-edges.
            Twin::Pair(t) => component.edges += u64::from(h < t),
            Twin::Flipped(t) => {
                component.edges += u64::from(h < t);
                component.oriented = false;
            }
            Twin::Boundary => {
                component.edges += 1;
                component.boundary_edges += 1;
            }
            Twin::NonManifold | Twin::Collapsed => {}
        }
    }
    let mut balanced = vec![true; components.len()];
    for edge in surface.twins.non_manifold_edges() {
        let label = labels[edge[0] as usize / 3] as usize;
        components[label].edges += 1;
        components[label].edge_manifold = false;
        // Any order of positions serves, as long as both directions of an edge differ in it.
        let runs_up = |h: &&u32| surface.origin(**h) < surface.origin(next_in_face(**h));
        balanced[label] &= 2 * edge.iter().filter(runs_up).count() == edge.len();
    }
    balanced
}

/// Counts the positions of each component, and detects positions at which it has two fans.
fn count_positions(surface: &MeshConnectivity, labels: &[u32], components: &mut [Component]) {
    let mut first_at = vec![NONE; surface.mesh.positions().len()];
    // The fans after the first at a position may belong to other components, so they are sorted out
    // afterwards.
    let mut further: Vec<(u32, u32)> = Vec::new();
    count_fans(
        &surface.twins,
        |h| surface.origin(h),
        first_at.len(),
        |h, number| {
            let (position, label) = (surface.origin(h), labels[h as usize / 3]);
            if number == 0 {
                first_at[position as usize] = label;
                components[label as usize].positions += 1;
            } else {
                further.push((position, label));
            }
        },
    );
    further.sort_unstable();
    for same in further.chunk_by(|a, b| a == b) {
        let (position, label) = same[0];
        let component = &mut components[label as usize];
        // The position was counted for the component of its first fan. For any other component it
        // counts here, once; a component with two fans at a position, whichever of them comes
        // first, is not manifold there.
        let is_first = first_at[position as usize] == label;
        component.positions += u64::from(!is_first);
        component.vertex_manifold &= !is_first && same.len() == 1;
    }
}

/// A sum of products with a bound on its rounding error.
#[derive(Clone, Copy, Default)]
struct SignedVolume {
    sum: f64,
    /// The sum of the absolute values of all products.
    size: f64,
    terms: f64,
}

impl SignedVolume {
    /// −1, 1, or 0 if rounding leaves the sign undecided.
    fn sign(&self) -> i8 {
        // A product of three differences and the sums in a term round fewer than 16 times; each term is then
        // rounded with every later one. Twice that, since `size` is rounded as well, and underflow on top.
        let slack = (self.terms + 16.0) * f64::EPSILON * self.size + self.terms * f64::MIN_POSITIVE;
        match self.sum.abs() > slack {
            true if self.sum > 0.0 => 1,
            true => -1,
            false => 0,
        }
    }
}

/// Computes area, volume and bounding box of each component, summed in the order of the faces. The apex of
/// the tetrahedra is the first corner of the component, so that its position in space costs no digits.
fn measure_components(mesh: &Mesh, labels: &[u32], components: &mut [Component]) -> Vec<SignedVolume> {
    let bounds = mesh.bounds();
    let size = bounds.min.iter().chain(&bounds.max).fold(0.0, |most: f64, x| {
        let x = x.abs();
        greater(x, most)
    });
    // By a power of two, so that scaling rounds nothing but what underflows, which `SignedVolume::sign` allows for,
    // and products of three lengths stay in range.
    let (down, up) = power_of_two_near(size);
    let at = |row: u32| DVec3::from(mesh.positions()[row as usize]) * down;
    let tips: Vec<DVec3> = components.iter().map(|c| at(mesh.faces()[c.first_face as usize][0])).collect();
    let mut volumes = vec![SignedVolume::default(); components.len()];
    for (face, &label) in mesh.faces().iter().zip(labels).filter(|(_, label)| **label != NONE) {
        let (component, volume) = (&mut components[label as usize], &mut volumes[label as usize]);
        let tip = tips[label as usize];
        let [a, b, c] = face.map(|row| at(row) - tip);
        let twice_area = (b - a).cross(c - a);
        component.measure.area += twice_area.length();
        volume.sum += a.dot(b.cross(c));
        // The sum of the absolute values of all products in the volume: its rounding error is a
        // share of that, which decides whether the sign is certain.
        let (p, q) = (b.abs(), c.abs());
        let sizes = DVec3::new(p.y * q.z + p.z * q.y, p.z * q.x + p.x * q.z, p.x * q.y + p.y * q.x);
        volume.size += a.abs().dot(sizes);
        volume.terms += 1.0;
        for row in face {
            extend(&mut component.bounds, &mesh.positions()[*row as usize]);
        }
    }
    for (component, volume) in components.iter_mut().zip(&volumes) {
        component.measure.area = component.measure.area / 2.0 * up * up;
        component.measure.signed_volume = volume.sum / 6.0 * up * up * up;
    }
    volumes
}

/// [`Box3::with`] in place.
#[inline]
fn extend(bounds: &mut Box3, p: &[f64; 3]) {
    for ((x, low), high) in p.iter().zip(&mut bounds.min).zip(&mut bounds.max) {
        *low = if x < low { *x } else { *low };
        *high = if x > high { *x } else { *high };
    }
}
