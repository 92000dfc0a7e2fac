//! Cages of the corpus: `v`, `f` and `t` lines of OBJ.
use chordal::explicit::subdivision::{Boundary, CreasingMethod, Scheme};
use chordal::explicit::{Cage, InvalidCage};
use std::path::PathBuf;

/// Positions and faces of a file.
pub fn polygons(text: &str) -> (Vec<[f64; 3]>, Vec<Vec<u32>>) {
    let (mut positions, mut faces) = (Vec::new(), Vec::new());
    for line in text.lines() {
        let mut words = line.split_whitespace();
        match words.next() {
            Some("v") => {
                let mut next = || words.next().unwrap().parse().unwrap();
                positions.push([next(), next(), next()]);
            }
            Some("f") => {
                let index = |word: &str| word.split('/').next().unwrap().parse::<u32>().unwrap() - 1;
                faces.push(words.map(index).collect());
            }
            _ => {}
        }
    }
    (positions, faces)
}

/// A cage of OpenSubdiv's regression shapes. In those `interpolateboundary` 1 is edges and corners and 2 is
/// edges only.
pub fn cage(name: &str, text: &str) -> Result<Cage, InvalidCage> {
    let (positions, faces) = polygons(text);
    let mut cage = Cage::new(positions, faces)?;
    let (mut creases, mut corners, mut holes) = (Vec::new(), Vec::new(), Vec::new());
    for line in text.lines().filter(|line| line.starts_with("t ")) {
        let words: Vec<&str> = line.split_whitespace().collect();
        let counts: Vec<usize> = words[2].split('/').map(|n| n.parse().unwrap()).collect();
        let ints: Vec<u32> = words[3..3 + counts[0]].iter().map(|n| n.parse().unwrap()).collect();
        let floats: Vec<f64> =
            words[3 + counts[0]..][..counts[1]].iter().map(|x| x.parse().unwrap()).collect();
        match words[1] {
            "crease" => creases.extend(ints.chunks_exact(2).map(|e| ([e[0], e[1]], floats[0]))),
            "corner" => corners.extend(ints.iter().map(|v| (*v, floats[0]))),
            "hole" => holes.extend(ints),
            "creasemethod" if words.last() == Some(&"chaikin") => {
                cage = cage.with_creasing(CreasingMethod::Chaikin)
            }
            "interpolateboundary" => {
                cage = cage.with_boundary(match ints[0] {
                    0 => Boundary::None,
                    1 => Boundary::EdgeAndCorner,
                    _ => Boundary::EdgeOnly,
                });
            }
            _ => {}
        }
    }
    let scheme = match name.split('_').next() {
        Some("loop") => Scheme::Loop,
        Some("bilinear") => Scheme::Bilinear,
        _ => Scheme::CatmullClark,
    };
    cage.with_creases(&creases)?.with_sharp_vertices(&corners)?.with_holes(&holes)?.with_scheme(scheme)
}

/// All of them, by name, but for poles of quads that have a vertex twice.
pub fn cages() -> Vec<(String, Cage)> {
    let Some(folder) = chordal_testkit::corpus::find("subdiv") else { return Vec::new() };
    let files = std::fs::read_dir(folder.join("cages")).unwrap();
    let mut names: Vec<PathBuf> = files.map(|file| file.unwrap().path()).collect();
    names.sort();
    let named = |path: PathBuf| {
        let name = path.file_stem().unwrap().to_string_lossy().into_owned();
        match cage(&name, &std::fs::read_to_string(&path).unwrap()) {
            Ok(cage) => Some((name, cage)),
            Err(error) => {
                let twice = matches!(error, InvalidCage::VertexTwice { .. });
                assert!(twice && name.starts_with("catmark_nonman_quadpole"), "{name}: {error}");
                None
            }
        }
    };
    names.into_iter().filter_map(named).collect()
}
