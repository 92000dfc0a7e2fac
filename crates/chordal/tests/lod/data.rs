//! Meshes that other people drew, read here by a few lines.
use chordal::Mesh;

/// A file below the folder of test data, its polygons cut into fans; `None` where there is none.
pub fn obj(path: &str) -> Option<Mesh> {
    let file = chordal_testkit::corpus::find(&format!("mesh/{path}"))?;
    let text = std::fs::read_to_string(file).expect("a text");
    let (mut positions, mut faces) = (Vec::new(), Vec::new());
    for line in text.lines() {
        let mut words = line.split_whitespace();
        match words.next() {
            Some("v") => {
                let v: Vec<f64> = words.map(|x| x.parse().expect("a number")).collect();
                positions.push([v[0], v[1], v[2]]);
            }
            Some("f") => {
                let index = |word: &str| {
                    word.split('/').next().expect("an index").parse::<u32>().expect("a number") - 1
                };
                let v: Vec<u32> = words.map(index).collect();
                faces.extend((1..v.len() - 1).map(|k| [v[0], v[k], v[k + 1]]));
            }
            _ => {}
        }
    }
    Some(Mesh::new(positions, faces).expect("a mesh"))
}
