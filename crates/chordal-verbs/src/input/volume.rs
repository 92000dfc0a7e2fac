//! `VolumeShape`: a volume with the choice of its surface, and the level that its samples suggest.
use super::smoothing_width::SmoothingWidth;
use chordal::convert::{Border, Inside};
use chordal::implicit::evaluation::SampleGrid;
use chordal::implicit::{Grid, Samples};
use chordal::math::{Box3, greater, lesser};
use chordal_io::Volume;
use std::collections::BTreeMap;

/// A volume with the choice of its surface.
#[derive(Clone, Debug, PartialEq)]
pub struct VolumeShape {
    /// The samples.
    pub volume: Volume,
    /// The surface.
    pub surface: SurfaceSpec,
}

impl VolumeShape {
    /// The box of all samples.
    #[must_use]
    pub fn bounds(&self) -> Box3 {
        let last = self.volume.grid.size().map(|n| (n - 1) as f64);
        (0..8).fold(Box3::EMPTY, |bounds, corner| {
            let index = std::array::from_fn(|k| if corner >> k & 1 == 1 { last[k] } else { 0.0 });
            bounds.with(self.volume.grid.affine().at(index))
        })
    }
}

/// The choice of a volume's surface; values that are not given follow from the samples.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SurfaceSpec {
    /// The level.
    pub level: Option<f64>,
    /// Which samples are inside.
    pub inside: Option<Inside>,
    /// How the border is treated.
    pub border: Border,
    /// Treats samples as labels, each with a surface of its own.
    pub labels: Option<LabelSelection>,
    /// Smooths a mask.
    pub smooth: Option<SmoothingWidth>,
}

/// The labels that get a surface.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum LabelSelection {
    /// All but 0, the background.
    All,
    /// The labels in a list.
    Listed(Vec<i64>),
}

/// A summary of the samples.
#[derive(Clone, Debug, PartialEq)]
pub struct ValueRange {
    /// The lowest and highest finite sample; `None` if there is none.
    pub ends: Option<[f64; 2]>,
    /// Samples that are NaN.
    pub nan: u64,
    /// Samples that are infinite.
    pub infinite: u64,
    /// Whether all finite samples are whole numbers, of whatever type.
    pub is_whole: bool,
    /// How often each value occurs, if all are whole numbers and there are few enough distinct values.
    pub labels: Option<BTreeMap<i64, u64>>,
}

/// A suggested level.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SuggestedLevel {
    /// The level.
    pub level: f64,
    /// Which samples are inside.
    pub inside: Inside,
    /// The interpretation of the samples: "mask", "occupancy", "signed distance" or "intensity".
    pub kind: &'static str,
}

impl SuggestedLevel {
    /// Whether the level follows from the kind of samples; otherwise it is a guess.
    #[must_use]
    pub fn follows(&self) -> bool {
        self.kind != "intensity"
    }
}

/// The tolerance around 0 for floating-point samples of an occupancy, and the least value near 1. Chosen: so that ambiguous
/// samples require an explicit level instead of a guess.
const FROM_0: f64 = 0.05;
const NEARLY_1: f64 = 0.9;
/// The most distinct values that may be labels. Chosen: larger values take scans in few gray levels for labels.
const FEW_LABELS: usize = 128;

/// Whether the file states that the samples are baked distances.
fn is_baked(volume: &Volume) -> bool {
    volume
        .certificate
        .as_ref()
        .and_then(|certificate| certificate.get("baked"))
        .is_some_and(|baked| !baked.is_null())
}

/// Samples with more distinct values than this are not labels.
const MOST_LABELS: usize = 1 << 16;

/// Whether a finite sample is a whole number. Numbers beyond `i64` are never labels.
fn is_whole(x: f64) -> bool {
    // Defined: the range of i64, whose upper end is no double.
    x == x.trunc() && (-9_223_372_036_854_775_808.0..9_223_372_036_854_775_808.0).contains(&x)
}

/// The numbers of samples at the ends of a lattice: below 0, above 0, and all that are not NaN.
struct EndSigns {
    below: u64,
    above: u64,
    total: u64,
}

impl EndSigns {
    fn from_grid(grid: &Grid) -> Self {
        let [nx, ny, nz] = grid.size();
        let mut signs = Self { below: 0, above: 0, total: 0 };
        for z in 0..nz {
            for y in 0..ny {
                let is_end = z == 0 || z + 1 == nz || y == 0 || y + 1 == ny;
                let step = if is_end { 1 } else { (nx - 1).max(1) };
                for x in (0..nx).step_by(step) {
                    let sample = grid.sample([x, y, z]);
                    signs.below += u64::from(sample < 0.0);
                    signs.above += u64::from(sample > 0.0);
                    signs.total += u64::from(!sample.is_nan());
                }
            }
        }
        signs
    }
}

impl ValueRange {
    /// Summarises the samples in one pass.
    #[must_use]
    pub fn from_samples(samples: &Samples) -> Self {
        let mut range =
            Self { ends: None, nan: 0, infinite: 0, is_whole: true, labels: Some(BTreeMap::new()) };
        // A run of equal samples is looked up once.
        let (mut last, mut times) = (0, 0);
        for i in 0..samples.len() {
            let x = samples.get(i);
            if !x.is_finite() {
                range.nan += u64::from(x.is_nan());
                range.infinite += u64::from(x.is_infinite());
                continue;
            }
            let [low, high] = range.ends.unwrap_or([x, x]);
            range.ends = Some([lesser(x, low), greater(x, high)]);
            if range.is_whole && !is_whole(x) {
                (range.is_whole, range.labels, times) = (false, None, 0);
            }
            if range.labels.is_some() {
                if x as i64 != last {
                    range.count(last, times);
                    (last, times) = (x as i64, 0);
                }
                times += 1;
            }
        }
        range.count(last, times);
        range
    }

    /// Whether the samples may be labels: few different whole numbers, 0 among them.
    pub(crate) fn may_be_labels(&self) -> bool {
        let few = |labels: &BTreeMap<i64, u64>| labels.len() <= FEW_LABELS && labels.contains_key(&0);
        self.labels.as_ref().is_some_and(few)
    }

    fn count(&mut self, label: i64, times: u64) {
        let Some(labels) = self.labels.as_mut().filter(|_| times > 0) else { return };
        *labels.entry(label).or_insert(0) += times;
        if labels.len() > MOST_LABELS {
            self.labels = None;
        }
    }

    /// The default for which samples are inside at a level. It depends on the numbers and not on their type, so that a scan
    /// is the same solid in whole numbers and in floats. At level 0, the sign at most ends of the lattice is outside: a
    /// scan has air there, below 0, and distances are positive outside.
    pub(crate) fn default_side(&self, level: f64, volume: &Volume) -> Inside {
        match self.suggest(volume) {
            Some(suggestion) if suggestion.level == level => suggestion.inside,
            _ if level == 0.0 && self.is_signed() => side_of_ends(&EndSigns::from_grid(&volume.grid)),
            _ => Inside::High,
        }
    }

    /// Whether there are samples on both sides of 0.
    fn is_signed(&self) -> bool {
        self.ends.is_some_and(|[low, high]| low < 0.0 && high > 0.0)
    }

    /// Whether samples look like distances: most ends of the lattice are positive, that is, outside. If the samples are
    /// whole numbers, all ends have to be positive, since many intensities and few distances are whole numbers.
    fn looks_like_distances(&self, volume: &Volume) -> bool {
        if !self.is_signed() {
            return false;
        }
        let signs = EndSigns::from_grid(&volume.grid);
        if self.is_whole { signs.above == signs.total } else { side_of_ends(&signs) == Inside::Low }
    }

    /// Suggests a level for samples in this range; `None` if all are equal.
    #[must_use]
    pub fn suggest(&self, volume: &Volume) -> Option<SuggestedLevel> {
        let samples = volume.grid.samples();
        let [low, high] = self.ends.filter(|[low, high]| low < high)?;
        let is_float = !self.is_whole;
        let suggestion = |level, inside, kind| Some(SuggestedLevel { level, inside, kind });
        if is_baked(volume) || self.looks_like_distances(volume) {
            return suggestion(0.0, Inside::Low, "signed distance");
        }
        if !is_float && self.labels.as_ref().is_some_and(|values| values.len() == 2) {
            let level = 0.5 * low + 0.5 * high;
            let is_signed = level == 0.0 && self.is_signed();
            let side =
                if is_signed { side_of_ends(&EndSigns::from_grid(&volume.grid)) } else { Inside::High };
            return suggestion(level, side, "mask");
        }
        // Samples between 0 and well below 1 may also be distances from a sheet.
        let is_sheet = low < FROM_0 && high < NEARLY_1;
        if is_float && low >= 0.0 && high <= 1.0 && low < 0.5 && high > 0.5 && !is_sheet {
            return suggestion(0.5, Inside::High, "occupancy");
        }
        let level = otsu_threshold(samples, [low, high]);
        // Between whole numbers no sample equals the level.
        suggestion(if is_float { level } else { level.floor() + 0.5 }, Inside::High, "intensity")
    }
}

/// The side of 0 that is inside, if the other side is at most ends of the lattice.
fn side_of_ends(signs: &EndSigns) -> Inside {
    if 2 * signs.below > signs.total { Inside::High } else { Inside::Low }
}

/// Whether samples at the border of a lattice are inside the surface at a level, so that it reaches the border.
pub(crate) fn reaches_border<G: SampleGrid>(grid: &G, level: f64, inside: Inside) -> bool {
    let [nx, ny, nz] = grid.size();
    let is_inside = |at: [usize; 3]| match inside {
        Inside::Low => grid.sample(at) <= level,
        Inside::High => grid.sample(at) >= level,
    };
    (0..nz).any(|k| {
        (0..ny).any(|j| {
            let is_side = k == 0 || k + 1 == nz || j == 0 || j + 1 == ny;
            if is_side {
                (0..nx).any(|i| is_inside([i, j, k]))
            } else {
                is_inside([0, j, k]) || is_inside([nx - 1, j, k])
            }
        })
    })
}

/// Bins of a histogram. Chosen: as many as 8-bit samples have values.
const BOXES: usize = 256;

/// The level that separates samples into two classes of maximal variance between them, by their histogram.
///
/// Source: N. Otsu, *A threshold selection method from gray-level histograms*, 1979.
fn otsu_threshold(samples: &Samples, [low, high]: [f64; 2]) -> f64 {
    let mut counts = [0_u64; BOXES];
    // Halves, so that the width of the range does not overflow.
    let width = high / 2.0 - low / 2.0;
    for i in 0..samples.len() {
        let x = samples.get(i);
        if x.is_finite() {
            let part = (x / 2.0 - low / 2.0) / width * BOXES as f64;
            counts[(part as usize).min(BOXES - 1)] += 1;
        }
    }
    let n_samples: u64 = counts.iter().sum();
    let total: f64 = counts.iter().enumerate().map(|(k, n)| k as f64 * *n as f64).sum();
    let (mut below, mut sum, mut most) = (0_u64, 0.0, -1.0);
    // Between modes that are far apart, many levels are equally good: remember the first and the last of them.
    let (mut best, mut last) = (0, 0);
    for (k, n) in counts.iter().enumerate().take(BOXES - 1) {
        below += n;
        sum += k as f64 * *n as f64;
        let above = n_samples - below;
        if below == 0 || above == 0 {
            continue;
        }
        let difference = sum / below as f64 - (total - sum) / above as f64;
        let between = below as f64 * above as f64 * difference * difference;
        if between > most {
            (best, most) = (k, between);
        }
        // Equal to the bit: empty boxes change none of the numbers.
        if between == most {
            last = k;
        }
    }
    // The level of a box is its upper end.
    low + 2.0 * width * (0.5 * (best + last + 2) as f64 / BOXES as f64)
}

/// The name of a sample type in a report.
pub(crate) fn type_name(samples: &Samples) -> &'static str {
    match samples {
        Samples::U8(_) => "u8",
        Samples::I8(_) => "i8",
        Samples::U16(_) => "u16",
        Samples::I16(_) => "i16",
        Samples::U32(_) => "u32",
        Samples::I32(_) => "i32",
        Samples::F32(_) => "f32",
        Samples::F64(_) => "f64",
        _ => "other",
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use chordal::implicit::Affine3;

    fn suggested(samples: &Samples) -> Option<SuggestedLevel> {
        let grid = Grid::new([samples.len(), 1, 1], samples.clone(), Affine3::IDENTITY).unwrap();
        ValueRange::from_samples(samples).suggest(&Volume::from_grid(grid))
    }

    #[test]
    fn the_level_follows_from_what_samples_are() {
        let mask = suggested(&Samples::U8(vec![0, 1, 1, 0])).unwrap();
        assert_eq!((mask.level, mask.inside, mask.kind), (0.5, Inside::High, "mask"));
        let eight = suggested(&Samples::U8(vec![0, 255, 255, 0])).unwrap();
        assert_eq!((eight.level, eight.inside, eight.kind), (127.5, Inside::High, "mask"));
        for soft in [vec![0.0, 0.25, 0.95], vec![0.3, 0.4, 0.6]] {
            let soft = suggested(&Samples::F32(soft)).unwrap();
            assert_eq!((soft.level, soft.inside, soft.kind), (0.5, Inside::High, "occupancy"));
        }
        // Distances from a sheet.
        assert!(!suggested(&Samples::F32(vec![0.0, 0.25, 0.52])).unwrap().follows());
        let distance = suggested(&Samples::F64(vec![-1.5, f64::NAN, 3.0])).unwrap();
        assert_eq!((distance.level, distance.inside, distance.kind), (0.0, Inside::Low, "signed distance"));
        assert!(suggested(&Samples::U8(vec![3; 9])).is_none());
        assert!(suggested(&Samples::F32(vec![f32::NAN; 9])).is_none());
    }

    #[test]
    fn the_same_numbers_are_the_same_solid_in_every_type() {
        let scan = [-1000_i16, -1000, 40, 40, -1000, -990];
        let distances = [3_i16, 1, -1, -2, 1, 3];
        for (numbers, inside) in [(scan, Inside::High), (distances, Inside::Low)] {
            let types = [
                Samples::I16(numbers.to_vec()),
                Samples::F32(numbers.iter().map(|x| f32::from(*x)).collect()),
                Samples::F64(numbers.iter().map(|x| f64::from(*x)).collect()),
                // A scale that is no whole number changes nothing.
                Samples::F64(numbers.iter().map(|x| 0.97 * f64::from(*x)).collect()),
            ];
            for samples in types {
                let range = ValueRange::from_samples(&samples);
                let volume = lattice_of(samples);
                assert_eq!(range.default_side(0.0, &volume), inside, "{volume:?}");
            }
        }
    }

    /// Samples in the middle of a lattice whose ends are the first of them.
    fn lattice_of(samples: Samples) -> Volume {
        let n = samples.len();
        let values = (0..3 * 3 * (n + 2)).map(|at| {
            let (x, yz) = (at % (n + 2), at / (n + 2));
            samples.get(if yz == 4 && x > 0 && x <= n { x - 1 } else { 0 })
        });
        let grid = Grid::new([n + 2, 3, 3], Samples::F64(values.collect()), Affine3::IDENTITY);
        Volume::from_grid(grid.unwrap())
    }

    #[test]
    fn whole_numbers_are_known_by_their_values() {
        let labels = ValueRange::from_samples(&Samples::F64(vec![0.0, 2.0, 2.0, f64::NAN, 7.0]));
        assert!(labels.is_whole);
        assert_eq!(labels.labels.unwrap().into_iter().collect::<Vec<_>>(), [(0, 1), (2, 2), (7, 1)]);
        let others = ValueRange::from_samples(&Samples::F32(vec![0.0, 2.0, 2.5]));
        assert!(!others.is_whole && others.labels.is_none());
    }

    #[test]
    fn intensities_are_parted_between_their_two_heaps() {
        let guess = suggested(&Samples::I16(vec![-1000, -990, -1000, 40, 60, 50])).unwrap();
        assert!(!guess.follows() && guess.level > -990.0 && guess.level < 40.0, "{guess:?}");
        assert_eq!(guess.level.fract().abs(), 0.5, "no sample equals it");
        let wide = suggested(&Samples::F64(vec![1.0, f64::MAX])).unwrap();
        assert!(wide.level > 1.0 && wide.level < f64::MAX);
    }

    #[test]
    fn a_range_counts_what_is_there() {
        let range =
            ValueRange::from_samples(&Samples::F32(vec![f32::NAN, 2.5, f32::INFINITY, -1.0, f32::NAN]));
        let seen = ValueRange { ends: Some([-1.0, 2.5]), nan: 2, infinite: 1, is_whole: false, labels: None };
        assert_eq!(range, seen);
        let range = ValueRange::from_samples(&Samples::U32(vec![5, 5, 0, 5, u32::MAX]));
        let labels: Vec<_> = range.labels.unwrap().into_iter().collect();
        assert_eq!(labels, [(0, 1), (5, 3), (i64::from(u32::MAX), 1)]);
        let many = Samples::I32((0..70_000).collect());
        assert!(ValueRange::from_samples(&many).labels.is_none(), "these are no labels");
    }
}
