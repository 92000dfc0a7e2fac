//! `LodOutcome`: levels of detail with their certificate.
use super::LodSpec;
use super::scene_levels::{SceneLevel, SceneLevels};
use super::tile_hierarchy::TileHierarchy;
use crate::report::{Certificate, LevelChoiceFacts, LevelFacts, LevelsFacts, ViewFacts};
use chordal::budget::advice::Message;
use chordal::budget::camera::MinDistanceView;
use chordal::budget::{Bound, View};
use chordal::lod::selection::{HYSTERESIS, SwitchDistances};
use chordal_io::Scene;
use chordal_io::glb::GltfPacking;
use std::borrow::Cow;

/// Levels of detail with their certificate.
#[derive(Clone, Debug, PartialEq)]
pub struct LodOutcome {
    pub(super) layout: LodLayout,
    pub(super) switches: SwitchDistances,
    pub(super) spec: LodSpec,
    pub(super) diagonal: f64,
    /// Why the finest level misses the budget, if it does.
    pub unmet: Option<Message>,
    /// The certificate for the report and for the file.
    pub certificate: Certificate,
}

/// The layout of the levels.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum LodLayout {
    /// Levels of each part.
    Levels(Box<SceneLevels>),
    /// A hierarchy of tiles over regions.
    Cut(Box<TileHierarchy>),
}

/// The diagonals of the box on the screen, in pixels, that get a row in the table. Chosen: from a screen to a speck.
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
                levels.map(facts_of).collect()
            }
            Self::Cut(cut) => cut.counts(),
        }
    }
}

fn facts_of(level: &SceneLevel) -> LevelFacts {
    let SceneLevel { bound, triangles, vertices, attributes, .. } = level;
    LevelFacts {
        triangles: *triangles,
        vertices: *vertices,
        at_least: bound.at_least(),
        at_most: bound.at_most().unwrap_or(f64::INFINITY),
        evidence: bound.evidence().as_str(),
        distance: None,
        tiles: 1,
        geometry: None,
        attributes: attributes.clone(),
    }
}

impl LodOutcome {
    /// Sets the storage of the numbers of all levels.
    pub(super) fn pack(&mut self, packing: GltfPacking) {
        match &mut self.layout {
            // Coarser levels take it from the finest one, when they are put together.
            LodLayout::Levels(levels) => levels.finest.packing = packing,
            LodLayout::Cut(cut) => cut.tiles.iter_mut().for_each(|tile| tile.scene.packing = packing),
        }
    }

    /// A level in the form in which it will be written, the finest first, with its bound; `None` if the finest level is cut
    /// in space, and beyond the last level.
    #[must_use]
    pub fn level(&self, k: usize) -> Option<(Cow<'_, Scene>, &Bound)> {
        let LodLayout::Levels(levels) = &self.layout else { return None };
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
}
