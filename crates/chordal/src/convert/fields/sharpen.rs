//! Bevelled creases and corners of a polygonized field made sharp.
//!
//! Marching cubes puts vertices on the edges of cells alone, and so bevels what is sharp. A loop of a cell whose normals turn is
//! filled by a fan around a vertex on the crease instead: where the planes of the groups of its normals meet, moved by planes
//! from nearer by, and taken only where the field is near 0 there, the place is in or beside the cell and no triangle
//! of the fan looks inward. Where two fans have an edge in common whose ends are on different sides of the crease, that edge
//! is turned so that it joins the two new vertices and follows the crease. A fan around a new vertex is a disc as the
//! triangles of the loop were, and an edge is turned only where it makes no second edge between two vertices; so
//! the mesh stays closed and manifold.
//!
//! Source: L. Kobbelt, M. Botsch, U. Schwanecke, H.-P. Seidel, *Feature sensitive surface extraction from volume data*, 2001.
use super::ask::Ask;
use super::planes::{Plane, between, corner, crease};
use super::polygonize::{Bevel, Polygonized, TURN};
use crate::budget::Job;
use crate::explicit::Mesh;
use crate::implicit::{LeafError, Tape};
use crate::math::{cross, difference, dot, length};

type Point = [f64; 3];

/// A third group of normals makes a corner where it leaves the plane of the other two by so much, about 30°; exactly a sine.
const THIRD: f64 = 0.5;
/// This share of the way to its vertices a field shows its side of a crease.
const ASIDE: f64 = 0.2;
/// Times that a place is moved.
const STEPS: usize = 2;
/// Cells that a place may lie outside of its cell.
const BESIDE: f64 = 1.5;
/// A place is on a crease when it is off the surface by this share of its way from the loop,
const ON: f64 = 0.125;
/// or of this share of a cell, where that is longer.
const NEAR: f64 = 0.1;

/// The triangles with creases and corners where the lattice shows them.
pub(super) fn sharpen(tape: &Tape, made: Polygonized, step: f64, job: &Job) -> Result<Mesh, LeafError> {
    let Polygonized { mesh, normals, bevels } = made;
    if bevels.is_empty() {
        return Ok(mesh);
    }
    let ask = Ask { tape, job };
    let (positions, faces) = (mesh.positions().to_vec(), mesh.faces().to_vec());
    let mut work = Work { positions, faces, normals, step };
    let places = work.places(&ask, &bevels)?;
    let fans = work.fan(&bevels, &places);
    work.turn(&bevels, &fans);
    Ok(Mesh::new(work.positions, work.faces).expect("places were checked to be finite"))
}

struct Work {
    positions: Vec<Point>,
    faces: Vec<[u32; 3]>,
    normals: Vec<Point>,
    step: f64,
}

/// The sides of a crease or corner.
struct Sides {
    /// The middle of the loop.
    middle: Point,
    /// The middles of the groups of its vertices.
    groups: Vec<Point>,
    place: Option<Point>,
}

impl Work {
    /// The place on the crease for each bevel that has one.
    fn places(&self, ask: &Ask, bevels: &[Bevel]) -> Result<Vec<Option<Point>>, LeafError> {
        let mut all: Vec<Sides> = bevels.iter().map(|bevel| self.sides(bevel)).collect();
        for _ in 0..STEPS {
            let looks: Vec<Point> = all
                .iter()
                .flat_map(|sides| {
                    let from = sides.place.unwrap_or(sides.middle);
                    sides.groups.iter().map(move |group| between(from, *group, ASIDE))
                })
                .collect();
            let mut planes = ask.planes(&looks)?.into_iter();
            for sides in &mut all {
                let near: Vec<Option<Plane>> = planes.by_ref().take(sides.groups.len()).collect();
                let near: Option<Vec<Plane>> = near.into_iter().collect();
                sides.place = sides.place.and_then(|place| meet(place, &near?));
            }
        }
        let places: Vec<Point> = all.iter().map(|sides| sides.place.unwrap_or(sides.middle)).collect();
        let planes = ask.planes(&places)?;
        let good = |k: usize| {
            let place = all[k].place?;
            let far = length(difference(place, all[k].middle));
            let room = if far > NEAR * self.step { far } else { NEAR * self.step };
            let on = planes[k].is_some_and(|plane| plane.over(place).abs() <= ON * room);
            (on && self.fits(&bevels[k], place)).then_some(place)
        };
        Ok((0..all.len()).map(good).collect())
    }

    /// The groups of normals of a loop, and where their planes meet.
    fn sides(&self, bevel: &Bevel) -> Sides {
        let points: Vec<Point> = bevel.ring.iter().map(|v| self.positions[*v as usize]).collect();
        let normals: Vec<Point> = bevel.ring.iter().map(|v| self.normals[*v as usize]).collect();
        let n = points.len();
        let pairs = (0..n).flat_map(|a| (0..a).map(move |b| (a, b)));
        let (a, b) = pairs.fold((0, 0), |best, pair| {
            let turn = |(a, b): (usize, usize)| dot(normals[a], normals[b]);
            if best.0 == best.1 || turn(pair) < turn(best) { pair } else { best }
        });
        let along = cross(normals[a], normals[b]);
        let along = along.map(|x| x / length(along));
        let leaves = |c: usize| dot(normals[c], along).abs();
        let c = (0..n).fold(0, |best, c| if leaves(c) > leaves(best) { c } else { best });
        let seeds = if leaves(c) > THIRD { vec![a, b, c] } else { vec![a, b] };
        let mut planes = Vec::new();
        let mut groups = Vec::new();
        for k in 0..seeds.len() {
            let nearest = |i: &usize| {
                let like = |s: usize| dot(normals[*i], normals[seeds[s]]);
                (0..seeds.len()).fold(0, |best, s| if like(s) > like(best) { s } else { best }) == k
            };
            let members: Vec<usize> = (0..n).filter(nearest).collect();
            let middle = mean(members.iter().map(|i| points[*i]));
            planes.push(Plane::through(middle, mean(members.iter().map(|i| normals[*i]))));
            groups.push(middle);
        }
        let middle = mean(points.into_iter());
        let planes: Option<Vec<Plane>> = planes.into_iter().collect();
        Sides { middle, groups, place: planes.and_then(|planes| meet(middle, &planes)) }
    }

    /// Whether a place is in the cell or beside it, and no triangle of its fan looks inward on the side of its corners.
    fn fits(&self, bevel: &Bevel, place: Point) -> bool {
        let room = BESIDE * self.step;
        let within =
            |k: usize| place[k] > bevel.cell[k] - room && place[k] < bevel.cell[k] + self.step + room;
        let n = bevel.ring.len();
        (0..3).all(within)
            && (0..n).all(|k| {
                let ends = [bevel.ring[k], bevel.ring[(k + 1) % n]];
                let [a, b] = ends.map(|v| self.positions[v as usize]);
                let [na, nb] = ends.map(|v| self.normals[v as usize]);
                let normal = cross(difference(b, a), difference(place, a));
                dot(na, nb) < TURN || dot(normal, na) > 0.0 && dot(normal, nb) > 0.0
            })
    }

    /// Fans for the bevels with a place; the number of the new vertex of each.
    fn fan(&mut self, bevels: &[Bevel], places: &[Option<Point>]) -> Vec<Option<u32>> {
        let mut fans = Vec::with_capacity(bevels.len());
        let mut more = Vec::new();
        for (bevel, place) in bevels.iter().zip(places) {
            fans.push(place.map(|place| {
                let centre = self.positions.len() as u32;
                self.positions.push(place);
                let n = bevel.ring.len();
                let mut fan = (0..n).map(|k| [bevel.ring[k], bevel.ring[(k + 1) % n], centre]);
                // In the place of the old ones, and two at the end.
                for (slot, face) in self.faces[bevel.first as usize..][..n - 2].iter_mut().zip(fan.by_ref()) {
                    *slot = face;
                }
                more.extend(fan);
                centre
            }));
        }
        self.faces.extend(more);
        fans
    }

    /// Turns edges across the crease between two fans.
    fn turn(&mut self, bevels: &[Bevel], fans: &[Option<u32>]) {
        // Half edges of the rings by their ends, in order.
        let mut halves: Vec<([u32; 2], bool, u32)> = Vec::new();
        for (bevel, centre) in bevels.iter().zip(fans) {
            let Some(centre) = centre else { continue };
            let n = bevel.ring.len();
            for k in 0..n {
                let (a, b) = (bevel.ring[k], bevel.ring[(k + 1) % n]);
                let turns = dot(self.normals[a as usize], self.normals[b as usize]) < TURN;
                if turns {
                    halves.push(if a < b { ([a, b], false, *centre) } else { ([b, a], true, *centre) });
                }
            }
        }
        halves.sort_unstable();
        // Both fans of an edge: that of the half edge from the lower vertex, and the other.
        let mut pairs: Vec<([u32; 2], [u32; 2])> = halves
            .chunk_by(|x, y| x.0 == y.0)
            .filter(|pair| pair.len() == 2 && pair[0].1 != pair[1].1)
            .map(|pair| ([pair[0].2, pair[1].2], pair[0].0))
            .collect();
        pairs.sort_unstable_by_key(|(fans, edge)| (unordered(*fans), *edge));
        pairs.dedup_by_key(|(fans, _)| unordered(*fans));
        // Both triangles of each edge, by its ends and the fan.
        let mut turned: Vec<([u32; 3], [u32; 3])> = Vec::new();
        for ([x, y], [a, b]) in pairs {
            let good = |face: [u32; 3], v: u32| {
                let [p, q, r] = face.map(|v| self.positions[v as usize]);
                dot(cross(difference(q, p), difference(r, p)), self.normals[v as usize]) > 0.0
            };
            // a → b has x on its left.
            let (first, second) = ([x, a, y], [y, b, x]);
            if good(first, a) && good(second, b) {
                turned.push(([a, b, x], first));
                turned.push(([b, a, y], second));
            }
        }
        turned.sort_unstable();
        for face in &mut self.faces {
            if let Ok(k) = turned.binary_search_by_key(face, |(old, _)| *old) {
                *face = turned[k].1;
            }
        }
    }
}

fn unordered([a, b]: [u32; 2]) -> [u32; 2] {
    if a < b { [a, b] } else { [b, a] }
}

/// Where two or three planes meet, next to `p`.
fn meet(p: Point, planes: &[Plane]) -> Option<Point> {
    match planes {
        [a, b] => crease(p, a, b),
        [a, b, c] => corner(p, [a, b, c]),
        _ => None,
    }
}

fn mean(points: impl ExactSizeIterator<Item = Point>) -> Point {
    let n = points.len() as f64;
    points.fold([0.0; 3], |sum, p| [0, 1, 2].map(|k| sum[k] + p[k])).map(|x| x / n)
}
