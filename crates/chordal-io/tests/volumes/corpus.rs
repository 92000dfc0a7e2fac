//! Real volumes: sizes, places and sums, as nibabel 5 gives them.
use super::{load, values};
use chordal_io::{Content, Format, Limits, read_with};
use chordal_testkit::corpus;

struct Real {
    file: &'static str,
    size: [usize; 3],
    rows: [[f64; 4]; 3],
    least: f64,
    most: f64,
    sum: f64,
}

/// What nibabel says: `shape`, `affine`, and minimum, maximum and `math.fsum` of `get_fdata()`.
const REAL: [Real; 6] = [
    Real {
        file: "nilearn/nilearn/datasets/data/image_10426.nii.gz",
        size: [53, 63, 46],
        rows: [[-3.0, 0.0, 0.0, 78.0], [0.0, 3.0, 0.0, -112.0], [0.0, 0.0, 3.0, -50.0]],
        least: -7.941444396972656,
        most: 7.94134521484375,
        sum: 3460.168992704268,
    },
    Real {
        file: "nilearn/nilearn/datasets/data/mni_icbm152_t1_tal_nlin_sym_09a_converted.nii.gz",
        size: [197, 233, 189],
        rows: [[1.0, 0.0, 0.0, -98.0], [0.0, 1.0, 0.0, -134.0], [0.0, 0.0, 1.0, -72.0]],
        least: 0.0,
        most: 255.0,
        sum: 333468829.0,
    },
    Real {
        file: "totalsegmentator/tests/reference_files/example_ct_sm.nii.gz",
        size: [122, 101, 30],
        rows: [
            [3.0, 0.0, 0.0, -177.95632934570312],
            [0.0, 3.0, 0.0, 11.319000244140625],
            [0.0, 0.0, 3.0, 94.3017578125],
        ],
        least: -1100.0,
        most: 1207.0,
        sum: -130894872.0,
    },
    Real {
        file: "totalsegmentator/tests/reference_files/example_seg.nii.gz",
        size: [122, 101, 30],
        rows: [
            [3.0, 0.0, 0.0, -177.95632934570312],
            [0.0, 3.0, 0.0, 11.319000244140625],
            [0.0, 0.0, 3.0, 94.3017578125],
        ],
        least: 0.0,
        most: 117.0,
        sum: 2734697.0,
    },
    Real {
        file: "totalsegmentator/tests/reference_files/example_seg_fast/aorta.nii.gz",
        size: [122, 101, 30],
        rows: [
            [3.0, 0.0, 0.0, -177.95632934570312],
            [0.0, 3.0, 0.0, 11.319000244140625],
            [0.0, 0.0, 3.0, 94.3017578125],
        ],
        least: 0.0,
        most: 1.0,
        sum: 1174.0,
    },
    Real {
        file: "totalsegmentator/tests/reference_files/example_seg_fast/liver.nii.gz",
        size: [122, 101, 30],
        rows: [
            [3.0, 0.0, 0.0, -177.95632934570312],
            [0.0, 3.0, 0.0, 11.319000244140625],
            [0.0, 0.0, 3.0, 94.3017578125],
        ],
        least: 0.0,
        most: 1.0,
        sum: 39350.0,
    },
];

#[test]
fn real_volumes_read_as_by_nibabel() {
    let Some(root) = corpus::find("") else { return };
    for real in REAL {
        let bytes = std::fs::read(root.join("volume").join(real.file)).expect(real.file);
        assert_eq!(Format::sniff(&bytes), Some(Format::Nii), "{}", real.file);
        let (volume, _) = load(&bytes, Format::Nii);
        let all = values(&volume);
        assert_eq!(volume.grid.size(), real.size, "{}", real.file);
        assert_eq!(volume.grid.affine().rows(), real.rows, "{}", real.file);
        let ends =
            all.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| (low.min(*x), high.max(*x)));
        assert_eq!(ends, (real.least, real.most), "{}", real.file);
        let sum: f64 = all.iter().sum();
        assert!(
            (sum - real.sum).abs() <= 1e-9 * all.iter().map(|x| x.abs()).sum::<f64>(),
            "{}: {sum}",
            real.file
        );
    }
}

/// What SimpleITK 2.5 and VTK 9.7 say: size, step, maximum and sum; the origin and the minimum are 0.
const OTHERS: [PeerVolume; 6] = [
    ("HeadMRVolume.mhd", Format::MetaImage, [48, 62, 42], [4.0, 255.0, 3058332.0]),
    ("vase.vti", Format::Vti, [115, 101, 75], [1.0, 239.0, 10723131.0]),
    ("hydrogen/hydrogen.vti", Format::Vti, [64, 64, 64], [1.0, 1.0, 4856.008970333326]),
    ("bolt.slc", Format::Slc, [70, 123, 66], [1.0, 255.0, 19004049.0]),
    ("neghip.slc", Format::Slc, [66, 66, 66], [1.0, 255.0, 4824177.0]),
    ("nut.slc", Format::Slc, [68, 41, 59], [1.0, 255.0, 5807640.0]),
];
type PeerVolume = (&'static str, Format, [usize; 3], [f64; 3]);

#[test]
fn real_volumes_read_as_by_itk_and_vtk() {
    let Some(root) = corpus::find("") else { return };
    let folder = root.join("volume/vtk/Data");
    for (file, format, size, [step, most, sum]) in OTHERS {
        let bytes = std::fs::read(folder.join(file)).expect(file);
        assert_eq!(Format::sniff(&bytes), Some(format), "{file}");
        let mut open = |path: &str| std::fs::read(folder.join(path)).map_err(|error| error.to_string());
        let outcome = read_with(&bytes, format, &mut open, &Limits::default()).expect(file);
        let Content::Volume(volume) = outcome.content else { panic!("{file}") };
        assert_eq!(volume.grid.size(), size, "{file}");
        let rows = [[step, 0.0, 0.0, 0.0], [0.0, step, 0.0, 0.0], [0.0, 0.0, step, 0.0]];
        assert_eq!(volume.grid.affine().rows(), rows, "{file}");
        let all = values(&volume);
        assert_eq!(all.iter().copied().fold(0.0, f64::max), most, "{file}");
        assert_eq!(all.iter().copied().fold(0.0, f64::min), 0.0, "{file}");
        let found: f64 = all.iter().sum();
        assert!((found - sum).abs() <= 1e-9 * sum, "{file}: {found}");
    }
}
