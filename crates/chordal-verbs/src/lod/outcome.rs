//! `LodOutcome`: levels of detail with their certificate, and how they are written as one glTF.
use super::LodSpec;
use super::level_mesh::LevelMesh;
use super::scene_levels::SceneLevels;
use super::tile_hierarchy::TileHierarchy;
use crate::flatten;
use crate::report::{BoundFacts, Certificate, LevelChoiceFacts, LevelFacts, LevelsFacts, ViewFacts};
use chordal::budget::camera::MinDistanceView;
use chordal::budget::{Bound, View};
use chordal::lod::selection::{HYSTERESIS, SwitchDistances};
use chordal::math::{greater, lesser};
use chordal_io::{FileSet, Format, Scene, WriteError, glb};
use serde_json::{Value, json};
use std::borrow::Cow;
use std::io::Write;

/// Levels of detail with their certificate.
#[derive(Clone, Debug, PartialEq)]
pub struct LodOutcome {
    pub(super) made: LodLayout,
    pub(super) switches: SwitchDistances,
    pub(super) spec: LodSpec,
    pub(super) diagonal: f64,
    /// For the report, and for the file.
    pub certificate: Certificate,
}

/// How the levels are laid out.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum LodLayout {
    /// Each part in levels.
    Levels(Box<SceneLevels>),
    /// A hierarchy of tiles over regions.
    Cut(Box<TileHierarchy>),
}

/// The diagonals of the box on the screen, in pixels, that get a row in the table.
const COVERED: [f64; 4] = [1000.0, 200.0, 20.0, 2.0];

impl LodLayout {
    /// The finest level as a scene.
    pub fn finest_scene(&self) -> &Scene {
        match self {
            Self::Levels(levels) => &levels.finest,
            Self::Cut(cut) => &cut.finest.scene,
        }
    }

    /// The bound of the finest level.
    pub fn finest_bound(&self) -> Option<&Bound> {
        match self {
            Self::Levels(levels) => levels.levels.first().map(|level| &level.bound),
            Self::Cut(cut) => Some(&cut.finest.bound),
        }
    }

    /// The levels to choose from.
    pub fn counts(&self) -> Vec<LevelFacts> {
        match self {
            Self::Levels(levels) => {
                let levels = levels.levels.iter();
                levels.map(|level| facts_of(level.triangles, level.vertices, &level.bound)).collect()
            }
            Self::Cut(cut) => cut.counts(),
        }
    }
}

fn facts_of(triangles: u64, vertices: u64, bound: &Bound) -> LevelFacts {
    LevelFacts {
        triangles,
        vertices,
        at_least: bound.at_least(),
        at_most: bound.at_most().unwrap_or(f64::INFINITY),
        evidence: bound.evidence().as_str(),
        distance: None,
        tiles: 1,
    }
}

impl LodOutcome {
    /// A level as it will be written, the finest first, with its bound; `None` where the finest level is cut
    /// in space, and beyond the last one.
    #[must_use]
    pub fn level(&self, k: usize) -> Option<(Cow<'_, Scene>, &Bound)> {
        let LodLayout::Levels(levels) = &self.made else { return None };
        Some((levels.scene(k)?, &levels.levels[k].bound))
    }

    pub(super) fn facts(&self, mut levels: Vec<LevelFacts>) -> LevelsFacts {
        let lens = &self.spec.lens;
        for (k, level) in levels.iter_mut().enumerate() {
            level.distance = self.switches.distance(k).filter(|distance| distance.is_finite());
        }
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
                LevelChoiceFacts {
                    distance,
                    covers_px: covers(distance),
                    level: shown.level,
                    triangles: levels[shown.level].triangles,
                    pixels: shown.pixels,
                }
            })
            .collect();
        let nearest =
            self.switches.distance(0).filter(|d| *d > 0.0 && d.is_finite()).unwrap_or(lens.distance);
        let view = ViewFacts::new(&View::MinDistance(MinDistanceView { distance: nearest, ..*lens }));
        LevelsFacts { pixels: self.spec.pixels.get(), view, hysteresis: HYSTERESIS, levels, shown }
    }

    /// Writes all levels as one glTF with `MSFT_lod`, binary or as JSON with all in it.
    ///
    /// # Errors
    /// As for [`glb::write_levels`]; [`WriteError::Unsupported`] for other formats than glTF, and where the
    /// finest level is cut in space.
    pub fn write(&self, format: Format, out: &mut dyn Write) -> Result<(), WriteError> {
        let (levels, coverages, certificate) = self.gltf_parts()?;
        let levels = gltf_levels(levels, &coverages, &certificate);
        match format {
            Format::Glb => glb::write_levels(&levels, out),
            Format::Gltf => glb::write_levels_embedded(&levels, out),
            other => Err(WriteError::Unsupported(format!("{other} holds no levels of detail"))),
        }
    }

    /// Writes all levels as a glTF called `stem` with its buffer and pictures beside it.
    ///
    /// # Errors
    /// As for [`Self::write`].
    pub fn write_files(&self, stem: &str) -> Result<FileSet<'static>, WriteError> {
        let (levels, coverages, certificate) = self.gltf_parts()?;
        let levels = gltf_levels(levels, &coverages, &certificate);
        glb::write_levels_files(&levels, stem).map(FileSet::into_owned)
    }

    /// What a glTF of levels is made of: the levels, the screen coverages, the certificate.
    fn gltf_parts(&self) -> Result<(&SceneLevels, Vec<Vec<f64>>, Value), WriteError> {
        let LodLayout::Levels(levels) = &self.made else {
            return Err(WriteError::Unsupported(
                "what is cut in space is a tileset, not one file".to_owned(),
            ));
        };
        let extras = |level: &super::scene_levels::SceneLevel| {
            extras_of(&self.certificate, &level.bound, level.triangles, level.vertices)
        };
        let mut of_levels: Vec<Value> = levels.levels.iter().map(extras).collect();
        let is_one = of_levels.len() == 1 && levels.coarser.iter().all(Vec::is_empty);
        let certificate = if is_one { of_levels.remove(0) } else { json!({ "levels": of_levels }) };
        Ok((levels, self.coverages(levels), certificate))
    }

    /// By node: the fraction of the screen that the bounding sphere of its part covers where each level gives
    /// way to the next. Viewers use its centre, which may be half a diagonal behind the side of the box.
    fn coverages(&self, levels: &SceneLevels) -> Vec<Vec<f64>> {
        let lens = &self.spec.lens;
        let pixels = f64::from(lens.screen.width_px) * f64::from(lens.screen.height_px);
        let placements = flatten::node_placements(&levels.finest);
        let of_node = |(node, place): (&chordal_io::Node, Option<flatten::NodePlacement>)| {
            let bounds = node.part.map(|part| &levels.bounds[part]).filter(|bounds| bounds.len() > 1);
            let Some(bounds) = bounds else { return Vec::new() };
            let place = place.unwrap_or(flatten::NodePlacement { stretch: 0.0, size: 0.0 });
            let error =
                |bound: &Bound| flatten::scaled_up(bound.at_most().unwrap_or(f64::INFINITY), place.stretch);
            let errors: Vec<f64> = bounds.iter().map(error).collect();
            let switches = SwitchDistances::new(&errors, *lens, self.spec.pixels);
            let mut before = f64::INFINITY;
            (0..errors.len())
                .map(|k| {
                    let next = switches.distance(k + 1).filter(|d| d.is_finite());
                    let Some((distance, focal)) = next.zip(lens.focal_px()) else { return 0.0 };
                    let across = place.size * focal / (distance + 0.5 * place.size);
                    let share = 0.25 * std::f64::consts::PI * across * across / pixels;
                    let share = if place.size > 0.0 { share } else { 0.0 };
                    // Fractions decrease from level to level, also where the part is larger than the screen
                    // or is scaled to nothing.
                    let most = if before <= 1.0 { 0.99 * before } else { 1.0 };
                    let least = (errors.len() - k) as f64 * f64::MIN_POSITIVE;
                    before = greater(lesser(share, most), least);
                    before
                })
                .collect()
        };
        levels.finest.nodes.iter().zip(placements).map(of_node).collect()
    }
}

fn gltf_levels<'a>(
    levels: &'a SceneLevels,
    coverages: &'a [Vec<f64>],
    certificate: &'a Value,
) -> glb::GlbLevels<'a> {
    let SceneLevels { finest: scene, coarser, .. } = levels;
    glb::GlbLevels { scene, coarser, coverages, certificate: Some(certificate) }
}

/// The extras of one mesh in its file.
pub(super) fn file_extras(certificate: &Certificate, made: &LevelMesh) -> Value {
    extras_of(certificate, &made.bound, made.triangles, made.vertices)
}

fn extras_of(certificate: &Certificate, bound: &Bound, triangles: u64, vertices: u64) -> Value {
    json!({
        "version": certificate.version,
        "input": certificate.input,
        "bound": BoundFacts::new(bound),
        "output": { "triangles": triangles, "vertices": vertices },
    })
}
