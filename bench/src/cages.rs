//! Cages as OpenSubdiv's regression shapes are written: an OBJ with tags.
use chordal::explicit::{Cage, InvalidCage};
use chordal::explicit::subdivision::{Boundary, CreasingMethod, Scheme};

/// Reads a file; the scheme is in its name.
///
/// # Errors
/// As for [`Cage::new`] and what tags are given by.
///
/// # Panics
/// When the file is not as those are.
pub fn read(path: &str) -> Result<Cage, InvalidCage> {
    let text = std::fs::read_to_string(path).expect("a cage");
    let (mut positions, mut faces) = (Vec::new(), Vec::<Vec<u32>>::new());
    let (mut creases, mut corners, mut holes) = (Vec::new(), Vec::new(), Vec::new());
    let (mut boundary, mut creasing) = (Boundary::EdgeOnly, CreasingMethod::Uniform);
    for line in text.lines() {
        let words: Vec<&str> = line.split_whitespace().collect();
        let float = |k: usize| words[k].parse::<f64>().expect("a number");
        match words.first() {
            Some(&"v") => positions.push([float(1), float(2), float(3)]),
            Some(&"f") => {
                let index = |word: &&str| word.split('/').next().and_then(|i| i.parse::<u32>().ok());
                faces.push(words[1..].iter().map(|word| index(word).expect("an index") - 1).collect());
            }
            Some(&"t") => {
                let n: usize = words[2].split('/').next().and_then(|n| n.parse().ok()).expect("a count");
                let ints: Vec<u32> = words[3..3 + n].iter().map(|i| i.parse().expect("an index")).collect();
                match words[1] {
                    "crease" => creases.extend(ints.chunks_exact(2).map(|e| ([e[0], e[1]], float(3 + n)))),
                    "corner" => corners.extend(ints.iter().map(|v| (*v, float(3 + n)))),
                    "hole" => holes.extend(ints),
                    "creasemethod" if words.last() == Some(&"chaikin") => creasing = CreasingMethod::Chaikin,
                    // In these files 1 is edges and corners.
                    "interpolateboundary" => {
                        boundary =
                            [Boundary::None, Boundary::EdgeAndCorner, Boundary::EdgeOnly][ints[0] as usize];
                    }
                    _ => {}
                }
            }
            _ => {}
        }
    }
    let cage = Cage::new(positions, faces)?.with_boundary(boundary).with_creasing(creasing);
    let cage = cage.with_creases(&creases).and_then(|cage| cage.with_sharp_vertices(&corners));
    let cage = cage.and_then(|cage| cage.with_holes(&holes))?;
    let is_loop = path.rsplit('/').next().is_some_and(|name| name.starts_with("loop"));
    if is_loop { cage.with_scheme(Scheme::Loop) } else { Ok(cage) }
}
