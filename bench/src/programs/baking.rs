//! The bench of meshes to grids of distances: `baking make MESH` writes the mesh; `baking full|band THREADS
//! MESH GRID` samples the distance on 128 cells along the longest side, everywhere or three cells around the
//! mesh, writes the grid for the peers to compare with, and prints a line of JSON with the median of the
//! seconds.
use chordal::convert::mesh_to_grid;
use chordal::{Job, Mesh};
use chordal_bench::{read, torus, write};
use serde_json::json;
use std::fs::File;
use std::io::{BufWriter, Write};
use std::path::Path;
use std::time::Instant;

/// FieldOctree along the longest side.
const CELLS: usize = 128;
/// FieldOctree that a band reaches on each side.
const BAND: f64 = 3.0;

pub fn main() {
    let words: Vec<String> = std::env::args().skip(1).collect();
    if words[0] == "make" {
        // 102,400 triangles.
        let mesh = torus([320, 160], 0.0, 0.1);
        let mut file = BufWriter::new(File::create(&words[1]).expect("a file to write"));
        return write(&mut file, mesh.positions(), mesh.faces()).expect("room on the disk");
    }
    let (positions, faces) = read(Path::new(&words[2])).expect("a mesh").swap_remove(0);
    let mesh = Mesh::new(positions, faces).expect("valid");
    let job = Job::default().with_threads(words[1].parse().expect("a number of threads"));
    let band = (words[0] == "band").then_some(BAND);
    let mut seconds = Vec::new();
    let mut last = None;
    for _ in 0..3 {
        let start = Instant::now();
        last = Some(mesh_to_grid(&mesh, CELLS, band, &job).expect("a solid"));
        seconds.push(start.elapsed().as_secs_f64());
    }
    seconds.sort_by(f64::total_cmp);
    let baked = last.expect("a run");
    let [nx, ny, nz] = baked.grid.size();
    let rows = baked.grid.affine().rows();
    let mut file = BufWriter::new(File::create(&words[3]).expect("a file to write"));
    let head = [nx as f64, ny as f64, nz as f64, rows[0][0], rows[0][3], rows[1][3], rows[2][3], baked.band];
    let samples = (0..nz).flat_map(|z| (0..ny).flat_map(move |y| (0..nx).map(move |x| [x, y, z])));
    for number in head.into_iter().chain(samples.map(|at| baked.grid.sample(at))) {
        file.write_all(&number.to_le_bytes()).expect("room on the disk");
    }
    println!("{}", json!({ "seconds": seconds[1], "samples": nx * ny * nz, "within": baked.n_within }));
}
