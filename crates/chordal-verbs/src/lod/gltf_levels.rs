//! Writes levels of detail as one glTF with `MSFT_lod`.
use super::LodOutcome;
use super::level_mesh::LevelMesh;
use super::outcome::LodLayout;
use super::scene_levels::{SceneLevel, SceneLevels};
use crate::provenance::geometry_digest::written_digest;
use crate::provenance::seal::{SEAL, seal_of};
use crate::report::{BoundFacts, Certificate, LevelFacts, to_value};
use crate::scene::placements;
use chordal::budget::Bound;
use chordal::lod::selection::SwitchDistances;
use chordal::math::{greater, lesser};
use chordal_io::{FileSet, Format, WriteError, glb};
use serde_json::{Value, json};
use std::io::Write;

impl LodOutcome {
    /// Writes all levels as one glTF with `MSFT_lod`, binary or as JSON with embedded buffers.
    ///
    /// # Errors
    /// As for [`glb::write_levels`]; [`WriteError::Unsupported`] for other formats than glTF, and if the finest level is cut
    /// in space.
    pub fn write(&self, format: Format, out: &mut dyn Write) -> Result<(), WriteError> {
        let (levels, coverages, certificate) = self.gltf_parts()?;
        let levels = gltf_levels(levels, &coverages, &certificate);
        match format {
            Format::Glb => glb::write_levels(&levels, out),
            Format::Gltf => glb::write_levels_embedded(&levels, out),
            other => Err(WriteError::Unsupported(format!("{other} holds no levels of detail"))),
        }
    }

    /// Writes all levels as a glTF called `stem`, with its buffer and pictures in files beside it.
    ///
    /// # Errors
    /// As for [`Self::write`].
    pub fn write_files(&self, stem: &str) -> Result<FileSet<'static>, WriteError> {
        let (levels, coverages, certificate) = self.gltf_parts()?;
        let levels = gltf_levels(levels, &coverages, &certificate);
        glb::write_levels_files(&levels, stem).map(FileSet::into_owned)
    }

    /// The content of a glTF of levels: the levels, the screen coverages and the certificate.
    fn gltf_parts(&self) -> Result<(&SceneLevels, Vec<Vec<f64>>, Value), WriteError> {
        let LodLayout::Levels(levels) = &self.layout else {
            return Err(WriteError::Unsupported(
                "a shape that is cut in space is a tileset, not one file".to_owned(),
            ));
        };
        let level_facts = self.certificate.verb.levels().map_or(&[][..], |facts| &facts.levels);
        let extras = |(level, facts): (&SceneLevel, &LevelFacts)| {
            let counts = (level.triangles, level.vertices);
            extras_of(&self.certificate, &level.bound, counts, facts.geometry.clone())
        };
        let mut level_extras: Vec<Value> = levels.levels.iter().zip(level_facts).map(extras).collect();
        let sources = &self.certificate.sources;
        if let Some(first) = level_extras.first_mut().filter(|_| !sources.is_empty()) {
            // The finest level stands for the file: the scripts are in it once.
            first["sources"] = to_value(sources);
            first[SEAL] = seal_of(first).into();
        }
        let is_single = level_extras.len() == 1 && levels.coarser.iter().all(Vec::is_empty);
        let certificate = if is_single { level_extras.remove(0) } else { json!({ "levels": level_extras }) };
        Ok((levels, self.coverages(levels), certificate))
    }

    /// By node: the fraction of the screen that the bounding sphere of its part covers when each level gives way to the
    /// next. Viewers use the sphere's centre, which may be half a diagonal behind the side of the box.
    fn coverages(&self, levels: &SceneLevels) -> Vec<Vec<f64>> {
        let lens = &self.spec.lens;
        let pixels = f64::from(lens.screen.width_px) * f64::from(lens.screen.height_px);
        let placements = placements::node_placements(&levels.finest);
        let of_node = |(node, place): (&chordal_io::Node, Option<placements::NodePlacement>)| {
            let bounds = node.part.map(|part| &levels.bounds[part]).filter(|bounds| bounds.len() > 1);
            let Some(bounds) = bounds else { return Vec::new() };
            let place = place.unwrap_or(placements::NodePlacement { stretch: 0.0, size: 0.0 });
            let error = |bound: &Bound| {
                placements::scaled_up(bound.at_most().unwrap_or(f64::INFINITY), place.stretch)
            };
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
                    // Fractions must decrease from level to level, also if the part is larger than the screen or is scaled
                    // to nothing.
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

/// The extras of one level's file.
pub(super) fn file_extras(certificate: &Certificate, level: &LevelMesh) -> Value {
    let geometry = written_digest(&level.scene, Format::Glb);
    extras_of(certificate, &level.bound, (level.triangles, level.vertices), geometry)
}

fn extras_of(
    certificate: &Certificate,
    bound: &Bound,
    (triangles, vertices): (u64, u64),
    geometry: Option<String>,
) -> Value {
    let bound = BoundFacts::new(bound);
    let mut extras = json!({
        "version": certificate.version,
        "input": certificate.input,
        "frame": certificate.frame,
        "bound": bound,
        "output": { "triangles": triangles, "vertices": vertices },
        "history": certificate.history_to(&bound, ("triangles", Format::Glb), geometry),
    });
    extras[SEAL] = seal_of(&extras).into();
    extras
}
