//! `lod`: any surface into levels of detail, each with its own bound, as one GLB or as 3D Tiles.
use crate::mesh::{refused, set_aside, snapped, widened};
use crate::placed::{self, Assembled, Placed};
use crate::polylines::Asked;
use crate::report::{
    BoundFacts, BudgetFacts, Certificate, Counted, LevelFacts, LevelsFacts, Output, ShownFacts, ViewFacts,
};
use crate::written::{as_written, unsupported};
use crate::{BudgetSpec, Input, MeshFailure, Normals, Shape, cage, implicit, surfaces};
use chordal::budget::{
    Bound, Budget, Closest, Code, Failure, Length, Pixels, Reference, Refusal, Stopped, Tolerance, View,
};
use chordal::explicit::Topology;
use chordal::lod::{self, Cuts, HYSTERESIS, Source, Steps, Switches};
use chordal::math::{Box3, add_up, mul_up};
use chordal::{Bounded, Job, Mesh, convert};
use chordal_io::tiles::{self, Tile, Tileset};
use chordal_io::{Axis, Format, Frame, Scene, WriteError, glb, snap, worst_snap};
use serde_json::{Value, json};
use std::io::Write;

/// Which levels are wanted.
#[derive(Clone, Debug, PartialEq)]
pub struct LodSpec {
    /// The most that may be lost on the screen.
    pub pixels: Pixels,
    /// The lens and the screen for which distances are computed; its own distance does not count.
    pub lens: Closest,
    /// The nearest that the eye comes to the box: the finest level is fine enough there.
    pub nearest: Option<f64>,
    /// What the finest level may lose, instead of what `nearest` says.
    pub length: Option<Length>,
    /// Distances for the table, beside those at which levels change and at which the shape covers few pixels.
    pub distances: Vec<f64>,
    /// Which normals triangles get.
    pub normals: Normals,
    /// What tiles say of their errors.
    pub errors: TileErrors,
    /// Triangles that a tile may have; a finest level with more is cut in space.
    pub tile_triangles: u64,
}

/// What tiles say of their errors, by which viewers choose.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum TileErrors {
    /// So much that viewers, whose formula holds in the middle of the screen, keep the pixels everywhere on it.
    #[default]
    Scaled,
    /// The proved error itself.
    Plain,
}

/// One level as it will be written.
#[derive(Clone, Debug, PartialEq)]
struct Made {
    scene: Scene,
    bound: Bound,
    triangles: u64,
    vertices: u64,
}

/// Levels of detail with everything that is known of them.
#[derive(Clone, Debug, PartialEq)]
pub struct LodOutcome {
    levels: Vec<Made>,
    switches: Switches,
    spec: LodSpec,
    diagonal: f64,
    /// For the report, and for the file.
    pub certificate: Certificate,
}

/// The diagonal of the box on the screen at which a row of the table is given, in pixels.
const COVERED: [f64; 4] = [1000.0, 200.0, 20.0, 2.0];

/// Turns a surface into levels of detail: see [`chordal::lod::chain`].
///
/// The finest level is within `spec.length`, or loses at most `spec.pixels` at `spec.nearest`, or, where neither is said,
/// where the box fills the height of the screen. Each level is proved against the shape itself, as it will be
/// written: positions in single precision.
///
/// # Errors
/// As for [`crate::mesh()`]; [`MeshFailure::Usage`] for curves, which have no levels.
pub fn lod(input: Input, spec: &LodSpec, job: &Job) -> Result<LodOutcome, MeshFailure> {
    if matches!(input.shape, Shape::Drawing(_) | Shape::Curves(_)) {
        return Err(MeshFailure::Usage("levels of detail are for surfaces, and these are curves".to_owned()));
    }
    let mut certificate = Certificate::of(&input);
    let place = input.shape.hull()?;
    let diagonal = input.shape.diagonal()?;
    let finest = finest(&input.shape, spec, &mut certificate)?;
    certificate.budget = Some(BudgetFacts::of(&Budget::length(finest)));
    let frame = *input.shape.frame();
    let from = input.format;
    // Rounding to single precision is the same for every level, about.
    let lost = worst_snap(&widened(&place), Format::Glb);
    let mut inner = set_aside(&Budget::length(finest), lost, &place, Format::Glb)?;
    let mut maker = Maker { shape: input.shape, notes: Vec::new(), place, job };
    let triangles = maker.triangles(&mut certificate.notes)?;
    if let Some((_, moved, _)) = &triangles {
        inner = set_aside(&inner, *moved, &place, Format::Glb)?;
    }
    let steps = Steps::from(inner.length.unwrap_or(finest));
    let (chain, moved) = match &triangles {
        Some((mesh, moved, topology)) => {
            (lod::chain(Source::Triangles(mesh, *topology), &steps, job), *moved)
        }
        None => {
            let mut make = |length: Tolerance| maker.make(length);
            (lod::chain(Source::Smooth(&mut make), &steps, job), 0.0)
        }
    };
    let chain = chain.map_err(|stopped| match stopped {
        Stopped::Refused(refusal) => MeshFailure::Refused(refusal),
        Stopped::Cancelled => MeshFailure::Cancelled,
    })?;
    certificate.notes.append(&mut maker.notes);
    certificate.notes.dedup();
    let mut levels: Vec<Made> = Vec::new();
    for level in chain {
        let (mesh, mut bound) = snapped(&level.mesh, level.bound, &Budget::default(), Format::Glb)?;
        if moved > 0.0 {
            bound = bound.then(&Bound::proved(0.0, moved, Reference::InputTriangles));
        }
        let mut scene = Scene::of(NAME, mesh, true, frame);
        let mut notes = Vec::new();
        spec.normals.apply(&mut scene, [normals_by(from), Format::Glb], &mut notes)?;
        certificate.notes.extend(notes.into_iter().filter(|_| levels.is_empty()));
        let scene = as_written(scene, Format::Glb)?;
        let (triangles, vertices) = scene.parts.iter().fold((0, 0), |(t, v), part| {
            (t + part.mesh.faces().len() as u64, v + part.mesh.positions().len() as u64)
        });
        // Rounding may leave two levels alike.
        if levels.last().is_none_or(|finer| bound.at_most() > finer.bound.at_most()) {
            levels.push(Made { scene, bound, triangles, vertices });
        }
    }
    let Some(first) = levels.first() else {
        return Err(refused(Code::Empty, "there is no triangle to show"));
    };
    certificate.bound = Some(BoundFacts::of(&first.bound));
    let counted = Counted::of(&first.scene, Format::Glb)?;
    certificate.output = Some(Output::Triangles(counted.output));
    certificate.valid = Some(counted.valid);
    let errors: Vec<f64> =
        levels.iter().map(|level| level.bound.at_most().unwrap_or(f64::INFINITY)).collect();
    let switches = Switches::new(&errors, spec.lens, spec.pixels);
    let mut outcome = LodOutcome { levels, switches, spec: spec.clone(), diagonal, certificate };
    outcome.certificate.levels = Some(outcome.facts());
    Ok(outcome)
}

/// The name of what is shown: no file name, which would tie the bytes to a place.
const NAME: &str = "level";

/// Which rows are one position when normals are made: what was simplified has indices of its own.
fn normals_by(from: Format) -> Format {
    if matches!(from, Format::Stl | Format::Glb) { Format::Obj } else { from }
}

/// What the finest level may lose.
fn finest(shape: &Shape, spec: &LodSpec, certificate: &mut Certificate) -> Result<Tolerance, MeshFailure> {
    if let Some(length) = spec.length {
        let asked = BudgetSpec { length: Some(length), ..BudgetSpec::default() };
        let (budget, note) = asked.resolve(shape)?;
        certificate.notes.extend(note);
        return budget.length.ok_or_else(|| refused(Code::Budget, "the budget has no length"));
    }
    let diagonal = shape.diagonal()?;
    let distance = spec.nearest.unwrap_or_else(|| match spec.lens.focal_px() {
        Some(focal) => diagonal * focal / f64::from(spec.lens.screen.height_px),
        None => 1.0,
    });
    if spec.nearest.is_none() {
        certificate.notes.push(format!(
            "nothing says how near the eye comes: the finest level is for {distance:.6}, where the box fills the height of \
             the screen"
        ));
    }
    let view = View::Closest(Closest { distance, ..spec.lens });
    let length = view.length_of(spec.pixels, &shape.hull()?).and_then(|length| Tolerance::new(length).ok());
    length.ok_or_else(|| {
        refused(
            Code::TooClose,
            "the shape has no size, or the eye is so close that no length is small enough",
        )
    })
}

/// What makes the triangles of a shape.
struct Maker<'a> {
    shape: Shape,
    notes: Vec<String>,
    place: Box3,
    job: &'a Job,
}

impl Maker<'_> {
    /// The triangles of a shape that is triangles, as one mesh, how far its places moved it, and how rows are tied.
    fn triangles(&mut self, notes: &mut Vec<String>) -> Result<Option<(Mesh, f64, Topology)>, MeshFailure> {
        let Shape::Scene(scene) = &mut self.shape else { return Ok(None) };
        let Placed { scene, moved_at_most, left_out } = placed::flattened(std::mem::take(scene))?;
        if left_out > 0 {
            notes.push(format!("parts that stand nowhere in the scene were left out ({left_out}x)"));
        }
        let shown = scene.parts.iter().filter(|part| !part.mesh.faces().is_empty()).count();
        if shown == 0 {
            return Err(refused(Code::Empty, "there is no triangle to make levels of"));
        }
        if scene.parts.len() == 1 && placed::n_places(&scene) == 1 {
            let part = scene.parts.into_iter().next();
            return Ok(part.map(|part| {
                let topology = if part.indexed { Topology::Indices } else { Topology::Positions };
                (part.mesh, moved_at_most, topology)
            }));
        }
        notes.push(format!("{shown} parts were put together; what their corners carry was left out"));
        let assembled = Assembled::of(&scene, Topology::Indices)?;
        Ok(Some((assembled.mesh, moved_at_most, Topology::Indices)))
    }

    /// Triangles within a length of a shape that is something smooth, at full precision.
    fn make(&mut self, length: Tolerance) -> Result<Bounded<Mesh>, Stopped> {
        let spec = BudgetSpec::default();
        let budget = Budget::length(length);
        // A format that keeps every digit.
        let to = Format::Ply;
        let (place, job) = (self.place, self.job);
        let made = match &self.shape {
            Shape::Patches { patches, .. } => {
                return match convert::patches_to_mesh(patches, &budget, job) {
                    Ok(made) => Ok(made),
                    Err(Failure::Unmet(best)) => Ok(*best),
                    Err(Failure::Refused(refusal)) => Err(Stopped::Refused(refusal)),
                    Err(Failure::Cancelled) => Err(Stopped::Cancelled),
                };
            }
            Shape::Cage(polygons) => cage::smooth(polygons, &Asked { spec: &spec, budget, to, place }, job),
            Shape::Volume(sampled) => {
                let asked = Asked { spec: &spec, budget, to, place: widened(&place) };
                surfaces::of_volume(sampled, &asked, &mut self.notes, job)
            }
            Shape::Field(field) => {
                let asked = Asked { spec: &spec, budget, to, place: widened(&place) };
                implicit::of_field(field, &asked, &mut self.notes, job)
            }
            _ => Err(refused(Code::Unsupported, "this shape has no levels")),
        };
        let (scene, bound) = made.map_err(|failure| match failure {
            MeshFailure::Cancelled => Stopped::Cancelled,
            MeshFailure::Refused(refusal) => Stopped::Refused(refusal),
            other => Stopped::Refused(Refusal { code: Code::Unsupported, message: other.to_string() }),
        })?;
        let mesh = placed::one_mesh(&scene).map(|mesh| mesh.into_owned());
        let mesh = mesh.map_err(|error| {
            Stopped::Refused(Refusal { code: Code::Unsupported, message: error.to_string() })
        })?;
        Ok(Bounded { shape: mesh, bound })
    }
}

impl LodOutcome {
    /// How many levels there are.
    #[must_use]
    pub fn n_levels(&self) -> usize {
        self.levels.len()
    }

    /// A level as it will be written, the finest first, with its bound.
    #[must_use]
    pub fn level(&self, k: usize) -> Option<(&Scene, &Bound)> {
        self.levels.get(k).map(|level| (&level.scene, &level.bound))
    }

    fn facts(&self) -> LevelsFacts {
        let lens = &self.spec.lens;
        let levels: Vec<LevelFacts> = self
            .levels
            .iter()
            .enumerate()
            .map(|(k, level)| LevelFacts {
                triangles: level.triangles,
                vertices: level.vertices,
                at_least: level.bound.at_least(),
                at_most: level.bound.at_most().unwrap_or(f64::INFINITY),
                distance: self.switches.distance(k).filter(|distance| distance.is_finite()),
            })
            .collect();
        let covers = |distance: f64| lens.focal_px().map_or(0.0, |focal| self.diagonal * focal / distance);
        let mut distances: Vec<f64> = self.spec.distances.clone();
        distances.extend(levels.iter().filter_map(|level| level.distance));
        distances.extend(
            lens.focal_px().into_iter().flat_map(|focal| COVERED.map(|px| self.diagonal * focal / px)),
        );
        distances.retain(|distance| *distance > 0.0 && distance.is_finite());
        distances.sort_by(f64::total_cmp);
        distances.dedup();
        let shown = distances
            .into_iter()
            .map(|distance| {
                let shown = self.switches.at(distance, None);
                ShownFacts {
                    distance,
                    covers_px: covers(distance),
                    level: shown.level,
                    triangles: self.levels[shown.level].triangles,
                    pixels: shown.pixels,
                }
            })
            .collect();
        let nearest =
            self.switches.distance(0).filter(|d| *d > 0.0 && d.is_finite()).unwrap_or(lens.distance);
        let view = ViewFacts::of(&View::Closest(Closest { distance: nearest, ..*lens }));
        LevelsFacts { pixels: self.spec.pixels.get(), view, hysteresis: HYSTERESIS, levels, shown }
    }

    /// What is said of one level in its file.
    fn certificate_of(&self, k: usize) -> Value {
        let facts = BoundFacts::of(&self.levels[k].bound);
        json!({
            "version": self.certificate.version,
            "input": self.certificate.input,
            "bound": facts,
            "output": { "triangles": self.levels[k].triangles, "vertices": self.levels[k].vertices },
        })
    }

    /// Writes all levels as one GLB with `MSFT_lod`.
    ///
    /// # Errors
    /// As for [`glb::write_levels`].
    pub fn write(&self, out: &mut dyn Write) -> Result<(), WriteError> {
        let certificates: Vec<Value> = (0..self.levels.len()).map(|k| self.certificate_of(k)).collect();
        let coverages = self.coverages();
        let levels: Vec<glb::Level<'_>> = self
            .levels
            .iter()
            .zip(&certificates)
            .zip(coverages)
            .map(|((level, certificate), coverage)| glb::Level {
                scene: &level.scene,
                certificate: Some(certificate),
                coverage,
            })
            .collect();
        glb::write_levels(&levels, out)
    }

    /// The share of the screen that a ball around the shape covers where each level gives way to the next.
    fn coverages(&self) -> Vec<f64> {
        let lens = &self.spec.lens;
        let pixels = f64::from(lens.screen.width_px) * f64::from(lens.screen.height_px);
        let mut before = f64::INFINITY;
        (0..self.levels.len())
            .map(|k| {
                let next = self.switches.distance(k + 1).filter(|d| d.is_finite());
                let Some((distance, focal)) = next.zip(lens.focal_px()) else { return 0.0 };
                let across = self.diagonal * focal / distance;
                let share = 0.25 * std::f64::consts::PI * across * across / pixels;
                // Shares fall from level to level, also where the shape is larger than the screen.
                let most = if before < 1.0 { 0.99 * before } else { 1.0 };
                before = if share < most { share } else { most };
                before
            })
            .collect()
    }

    /// The files of a tileset of 3D Tiles 1.1 by their names, `tileset.json` the last. Up to `spec.tile_triangles` in the
    /// finest level it has one tile a level, each the child of the next coarser one; above, the finest level is cut in
    /// space ([`chordal::lod::tree`]), and tiles meet without cracks whichever are shown.
    ///
    /// # Errors
    /// As for [`glb::write`], [`tiles::write`] and [`chordal::lod::tree`].
    pub fn tileset(&self, job: &Job) -> Result<Vec<(String, Vec<u8>)>, MeshFailure> {
        let mut files = Vec::new();
        let root = if self.levels[0].triangles > self.spec.tile_triangles {
            self.cut_in_space(&mut files, job)?
        } else {
            self.one_below_the_other(&mut files)?
        };
        let tileset = self.listed(root);
        let bytes = tiles::write(&tileset).map_err(|error| WriteError::Unsupported(error.to_string()))?;
        files.push(("tileset.json".to_owned(), bytes));
        Ok(files)
    }

    /// One tile a level.
    fn one_below_the_other(&self, files: &mut Files) -> Result<Tile, MeshFailure> {
        let metres = self.metres();
        let mut bounds = Box3::EMPTY;
        let mut tree: Option<Tile> = None;
        for (k, level) in self.levels.iter().enumerate() {
            let name = format!("level_{k}.glb");
            let mut bytes = Vec::new();
            glb::write(&level.scene, Some(&self.certificate_of(k)), &mut bytes)?;
            files.push((name.clone(), bytes));
            bounds = bounds.union(tiles::content_bounds(&level.scene)?);
            let mut tile = Tile::leaf(tiles::aligned_box(&bounds), &name);
            tile.extras = Some(said_of(&level.bound, level.triangles, metres));
            if let Some(finer) = tree.take() {
                tile.geometric_error = self.said(&level.bound, metres, finer.geometric_error);
                tile.children = vec![finer];
            }
            tree = Some(tile);
        }
        tree.ok_or_else(|| refused(Code::Empty, "there is no level"))
    }

    /// The finest level cut in space. Coordinates are those of single precision about one point for all tiles, so that what
    /// two of them share is one number.
    fn cut_in_space(&self, files: &mut Files, job: &Job) -> Result<Tile, MeshFailure> {
        let finest = &self.levels[0];
        let Some(part) = finest.scene.parts.first() else {
            return Err(refused(Code::Empty, "there is no triangle to cut"));
        };
        let origin = snap(&part.mesh, Format::Glb).map_err(MeshFailure::TooWide)?.origin;
        let about = |p: &[f64; 3]| -> [f64; 3] { std::array::from_fn(|k| p[k] - origin[k]) };
        let local = part.mesh.positions().iter().map(about).collect();
        let local = part.mesh.with_positions(local).map_err(unsupported)?;
        let step = finest.bound.at_most().and_then(|most| Tolerance::new(most).ok());
        // A finest level that lost nothing starts at about what single precision tells apart.
        let step = step.or_else(|| Tolerance::new(f64::from(f32::EPSILON) * self.diagonal).ok());
        let step = step.ok_or_else(|| refused(Code::Empty, "the shape has no size"))?;
        let cuts = Cuts { most: self.spec.tile_triangles as usize, ..Cuts::from(step) };
        let made = Bounded { shape: local, bound: finest.bound.clone() };
        let made = lod::tree(&made, Topology::Positions, &cuts, job).map_err(|stopped| match stopped {
            Stopped::Refused(refusal) => MeshFailure::Refused(refusal),
            Stopped::Cancelled => MeshFailure::Cancelled,
        })?;
        let metres = self.metres();
        // Children come after their parents, so that backwards every tile finds its children made.
        let mut done: Vec<Option<(Tile, Box3)>> = made.tiles.iter().map(|_| None).collect();
        for (k, tile) in made.tiles.iter().enumerate().rev() {
            let name = format!("tile_{k}.glb");
            // About zero, which all tiles share.
            let snapped = snap(&tile.mesh, Format::Stl).map_err(MeshFailure::TooWide)?;
            let moved = Bound::proved(0.0, snapped.moved_at_most, Reference::InputTriangles);
            let bound = tile.bound.then(&moved);
            let n = snapped.mesh.faces().len() as u64;
            let scene = Scene::of(NAME, snapped.mesh, true, finest.scene.frame);
            let mut bytes = Vec::new();
            let certificate = json!({ "version": self.certificate.version, "input": self.certificate.input,
                "bound": BoundFacts::of(&bound), "output": { "triangles": n } });
            glb::write(&scene, Some(&certificate), &mut bytes)?;
            files.push((name.clone(), bytes));
            let mut bounds = tiles::content_bounds(&scene)?;
            let (mut children, mut finer) = (Vec::new(), 0.0);
            for child in &tile.children {
                if let Some((child, inner)) = done[*child].take() {
                    bounds = bounds.union(inner);
                    finer = if child.geometric_error > finer { child.geometric_error } else { finer };
                    children.push(child);
                }
            }
            let mut made = Tile::leaf(tiles::aligned_box(&bounds), &name);
            made.extras = Some(said_of(&bound, n, metres));
            if !children.is_empty() {
                made.geometric_error = self.said(&bound, metres, finer);
                made.children = children;
            }
            done[k] = Some((made, bounds));
        }
        let mut roots: Vec<(Tile, Box3)> = made.roots.iter().filter_map(|root| done[*root].take()).collect();
        let mut root = if roots.len() == 1 {
            roots.remove(0).0
        } else {
            // Nothing coarser than several tiles together: an empty one above them.
            let bounds = roots.iter().fold(Box3::EMPTY, |all, (_, bounds)| all.union(*bounds));
            let finer =
                roots.iter().fold(
                    0.0,
                    |m: f64, (tile, _)| if tile.geometric_error > m { tile.geometric_error } else { m },
                );
            let mut above = Tile::leaf(tiles::aligned_box(&bounds), "");
            above.contents.clear();
            above.geometric_error = add_up(finer, bounds.diagonal());
            above.children = roots.into_iter().map(|(tile, _)| tile).collect();
            above
        };
        root.transform = placed_at(origin, &finest.scene.frame);
        Ok(root)
    }

    fn metres(&self) -> f64 {
        self.levels[0].scene.frame.metres_per_unit.unwrap_or(1.0)
    }

    fn listed(&self, root: Tile) -> Tileset {
        let scaled = self.spec.errors == TileErrors::Scaled;
        let pixels = self.spec.pixels.get();
        let said = if scaled {
            "scaled so that the viewers' formula keeps the pixels everywhere on the screen"
        } else {
            "the proved error"
        };
        Tileset {
            geometric_error: add_up(mul_up(self.diagonal, self.metres()), root.geometric_error),
            root,
            extras: Some(json!({ "chordal": {
                "certificate": self.certificate,
                "geometricError": said,
                "viewer": {
                    "3d-tiles-renderer": { "errorTarget": pixels },
                    "CesiumJS": { "maximumScreenSpaceError": pixels, "dynamicScreenSpaceError": false },
                },
            }})),
        }
    }

    /// What a tile says of its error: viewers show it from where this is the wanted pixels in the middle of the screen. More
    /// than its children say, as the specification wants it.
    fn said(&self, bound: &Bound, metres: f64, finer: f64) -> f64 {
        let lens = &self.spec.lens;
        let own = bound.at_most().unwrap_or(f64::INFINITY);
        let error = placed::scaled_up(own, metres);
        let far = Switches::new(&[own], *lens, self.spec.pixels).distance(0).filter(|d| d.is_finite());
        let said = match (self.spec.errors, far.zip(lens.focal_px())) {
            (TileErrors::Scaled, Some((distance, focal))) => {
                // Four roundings here and two in the viewer, up.
                let scaled = self.spec.pixels.get() * distance * metres / focal * (1.0 + 8.0 * f64::EPSILON); // as said
                if scaled > error { scaled } else { error }
            }
            _ => error,
        };
        let least = finer.next_up();
        if said > least { said } else { least }
    }
}

/// Files by their names.
type Files = Vec<(String, Vec<u8>)>;

/// What is said of a tile beside its error.
fn said_of(bound: &Bound, triangles: u64, metres: f64) -> Value {
    json!({ "chordal": {
        "at_most": placed::scaled_up(bound.at_most().unwrap_or(f64::INFINITY), metres), "triangles": triangles,
        "evidence": bound.evidence().as_str(), "reference": bound.reference.as_str(),
    }})
}

/// The matrix that brings coordinates about a point back, in the space of tiles: z-up and in metres.
fn placed_at(origin: [f64; 3], frame: &Frame) -> Option<Box<[f64; 16]>> {
    if origin == [0.0; 3] {
        return None;
    }
    let metres = frame.metres_per_unit.unwrap_or(1.0);
    let [x, y, z] = origin.map(|x| x * metres);
    let [x, y, z] = if frame.up == Some(Axis::Z) { [x, y, z] } else { [x, -z, y] };
    Some(Box::new([1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, x, y, z, 1.0]))
}
