//! The textbook difference of two meshes, in floating point with one tolerance: for comparison only. Planes of one mesh
//! cut the polygons of the other (a binary space partition); "on the plane" means within [`CLOSE`].
//!
//! Source: B. Naylor, J. Amanatides, W. Thibault, *Merging BSP trees yields polyhedral set operations*, 1990, as it is
//! written in many small programs.
use super::sight::{cross, dot};
use chordal::math::unit;

/// What counts as the same place.
pub(super) const CLOSE: f64 = 1e-5; // defined: what the programs that it stands for use

/// A convex polygon with its plane: normal · p = offset.
#[derive(Clone, Debug)]
pub(super) struct Facet {
    pub corners: Vec<[f64; 3]>,
    normal: [f64; 3],
    offset: f64,
}

impl Facet {
    /// `None` if the first three corners are on a line.
    pub fn new(corners: Vec<[f64; 3]>) -> Option<Self> {
        let side = |k: usize| std::array::from_fn(|c| corners[k][c] - corners[0][c]);
        let normal = unit(cross(side(1), side(2)))?;
        let offset = dot(normal, corners[0]);
        Some(Self { corners, normal, offset })
    }

    fn flipped(mut self) -> Self {
        self.corners.reverse();
        Self { normal: self.normal.map(|x| -x), offset: -self.offset, ..self }
    }
}

/// A node: a plane, the facets on it, and what is before and behind it.
#[derive(Default)]
struct Node {
    plane: Option<([f64; 3], f64)>,
    facets: Vec<Facet>,
    front: Option<Box<Node>>,
    back: Option<Box<Node>>,
}

/// The parts of facets by their side of a plane.
#[derive(Default)]
struct Sides {
    on_front: Vec<Facet>,
    on_back: Vec<Facet>,
    front: Vec<Facet>,
    back: Vec<Facet>,
}

impl Sides {
    fn add(&mut self, facet: Facet, (normal, offset): ([f64; 3], f64)) {
        let heights: Vec<f64> = facet.corners.iter().map(|p| dot(normal, *p) - offset).collect();
        let is_before = heights.iter().any(|h| *h > CLOSE);
        let is_behind = heights.iter().any(|h| *h < -CLOSE);
        match (is_before, is_behind) {
            (false, false) if dot(normal, facet.normal) > 0.0 => self.on_front.push(facet),
            (false, false) => self.on_back.push(facet),
            (true, false) => self.front.push(facet),
            (false, true) => self.back.push(facet),
            (true, true) => {
                let [mut front, mut back] = [Vec::new(), Vec::new()];
                let n = facet.corners.len();
                for i in 0..n {
                    let j = (i + 1) % n;
                    let ([a, b], [ha, hb]) = ([facet.corners[i], facet.corners[j]], [heights[i], heights[j]]);
                    if ha >= -CLOSE {
                        front.push(a);
                    }
                    if ha <= CLOSE {
                        back.push(a);
                    }
                    if (ha > CLOSE && hb < -CLOSE) || (ha < -CLOSE && hb > CLOSE) {
                        let share = ha / (ha - hb);
                        let cut = std::array::from_fn(|k| a[k] + share * (b[k] - a[k]));
                        front.push(cut);
                        back.push(cut);
                    }
                }
                let part =
                    |corners: Vec<[f64; 3]>| (corners.len() > 2).then(|| Facet { corners, ..facet.clone() });
                self.front.extend(part(front));
                self.back.extend(part(back));
            }
        }
    }
}

impl Node {
    fn build(&mut self, facets: Vec<Facet>) {
        let Some(first) = facets.first() else { return };
        let plane = *self.plane.get_or_insert((first.normal, first.offset));
        let mut sides = Sides::default();
        facets.into_iter().for_each(|facet| sides.add(facet, plane));
        self.facets.append(&mut sides.on_front);
        self.facets.append(&mut sides.on_back);
        for (child, facets) in [(&mut self.front, sides.front), (&mut self.back, sides.back)] {
            if !facets.is_empty() {
                child.get_or_insert_default().build(facets);
            }
        }
    }

    fn invert(&mut self) {
        self.facets = std::mem::take(&mut self.facets).into_iter().map(Facet::flipped).collect();
        self.plane = self.plane.map(|(normal, offset)| (normal.map(|x| -x), -offset));
        std::mem::swap(&mut self.front, &mut self.back);
        [&mut self.front, &mut self.back].into_iter().flatten().for_each(|child| child.invert());
    }

    /// The parts of facets that are not behind everything.
    fn clip(&self, facets: Vec<Facet>) -> Vec<Facet> {
        let Some(plane) = self.plane else { return facets };
        let mut sides = Sides::default();
        facets.into_iter().for_each(|facet| sides.add(facet, plane));
        sides.front.append(&mut sides.on_front);
        sides.back.append(&mut sides.on_back);
        let mut kept = match &self.front {
            Some(front) => front.clip(sides.front),
            None => sides.front,
        };
        if let Some(back) = &self.back {
            kept.append(&mut back.clip(sides.back));
        }
        kept
    }

    fn clip_to(&mut self, other: &Self) {
        self.facets = other.clip(std::mem::take(&mut self.facets));
        [&mut self.front, &mut self.back].into_iter().flatten().for_each(|child| child.clip_to(other));
    }

    fn all(&self) -> Vec<Facet> {
        let children = [&self.front, &self.back].into_iter().flatten();
        self.facets.iter().cloned().chain(children.flat_map(|child| child.all())).collect()
    }
}

/// The first solid without the second.
pub(super) fn difference(first: Vec<Facet>, second: Vec<Facet>) -> Vec<Facet> {
    let [mut a, mut b] = [Node::default(), Node::default()];
    a.build(first);
    b.build(second);
    a.invert();
    a.clip_to(&b);
    b.clip_to(&a);
    b.invert();
    b.clip_to(&a);
    b.invert();
    a.build(b.all());
    a.invert();
    a.all()
}

/// Facets as triangles: corners closer than [`CLOSE`] become one, and corners of others on a side are put into it.
pub(super) fn triangles(facets: &[Facet]) -> (Vec<[f64; 3]>, Vec<[u32; 3]>) {
    let mut positions: Vec<[f64; 3]> = Vec::new();
    let apart_sq = |a: [f64; 3], b: [f64; 3]| (0..3).map(|k| (a[k] - b[k]) * (a[k] - b[k])).sum::<f64>();
    let mut loops: Vec<Vec<u32>> = Vec::new();
    for facet in facets {
        let mut rows: Vec<u32> = Vec::new();
        for corner in &facet.corners {
            let known = positions.iter().position(|p| apart_sq(*p, *corner) <= CLOSE * CLOSE);
            let row = known.unwrap_or_else(|| {
                positions.push(*corner);
                positions.len() - 1
            }) as u32;
            if rows.last() != Some(&row) && rows.first() != Some(&row) {
                rows.push(row);
            }
        }
        loops.push(rows);
    }
    let n_corners = positions.len();
    let mut faces = Vec::new();
    for rows in loops.iter().filter(|rows| rows.len() > 2) {
        let mut full = Vec::new();
        for (i, &from) in rows.iter().enumerate() {
            let to = rows[(i + 1) % rows.len()];
            let [a, b] = [positions[from as usize], positions[to as usize]];
            let way: [f64; 3] = std::array::from_fn(|k| b[k] - a[k]);
            let length_sq = dot(way, way);
            let mut between: Vec<(f64, u32)> = Vec::new();
            for (row, p) in positions[..n_corners].iter().enumerate() {
                let from_a: [f64; 3] = std::array::from_fn(|k| p[k] - a[k]);
                let share = dot(way, from_a) / length_sq;
                let foot = std::array::from_fn(|k| a[k] + share * way[k]);
                let is_between = share > 0.0 && share < 1.0 && row as u32 != from && row as u32 != to;
                if is_between && apart_sq(foot, *p) <= CLOSE * CLOSE {
                    between.push((share, row as u32));
                }
            }
            between.sort_by(|a, b| a.0.total_cmp(&b.0));
            full.push(from);
            full.extend(between.iter().map(|(_, row)| row));
        }
        // A fan from a point inside, so that no triangle is flat where three corners are on a line.
        let middle = std::array::from_fn(|k| {
            rows.iter().map(|row| positions[*row as usize][k]).sum::<f64>() / rows.len() as f64
        });
        let centre = positions.len() as u32;
        positions.push(middle);
        faces.extend((0..full.len()).map(|i| [centre, full[i], full[(i + 1) % full.len()]]));
    }
    (positions, faces)
}
