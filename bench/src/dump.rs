//! Meshes as the engines hand them over: little-endian, per mesh the numbers of vertices and triangles as
//! u32, then f64 coordinates and u32 indices.
use std::io::{self, Write};
use std::path::Path;

/// Positions and triangles.
pub type Dumped = (Vec<[f64; 3]>, Vec<[u32; 3]>);

/// All meshes of a file.
pub fn read(path: &Path) -> io::Result<Vec<Dumped>> {
    let bytes = std::fs::read(path)?;
    let (mut rest, mut meshes) = (bytes.as_slice(), Vec::new());
    let cut = || io::Error::new(io::ErrorKind::UnexpectedEof, format!("{} is cut off", path.display()));
    let mut take = |n: usize| -> io::Result<Vec<u8>> {
        let (head, tail) = rest.split_at_checked(n).ok_or_else(cut)?;
        rest = tail;
        Ok(head.to_vec())
    };
    let mut left = bytes.len();
    while left > 0 {
        let head = take(8)?;
        let [n, m] = [0, 4].map(|i| u32::from_le_bytes(head[i..i + 4].try_into().expect("4 bytes")) as usize);
        let (points, faces) = (take(24 * n)?, take(12 * m)?);
        let number = |b: &[u8]| f64::from_le_bytes(b.try_into().expect("8 bytes"));
        let index = |b: &[u8]| u32::from_le_bytes(b.try_into().expect("4 bytes"));
        meshes.push((
            points.chunks(24).map(|p| [0, 8, 16].map(|k| number(&p[k..k + 8]))).collect(),
            faces.chunks(12).map(|f| [0, 4, 8].map(|k| index(&f[k..k + 4]))).collect(),
        ));
        left -= 8 + 24 * n + 12 * m;
    }
    Ok(meshes)
}

/// Writes one mesh after those that are there.
pub fn write(to: &mut impl Write, positions: &[[f64; 3]], faces: &[[u32; 3]]) -> io::Result<()> {
    to.write_all(&(positions.len() as u32).to_le_bytes())?;
    to.write_all(&(faces.len() as u32).to_le_bytes())?;
    for x in positions.as_flattened() {
        to.write_all(&x.to_le_bytes())?;
    }
    for i in faces.as_flattened() {
        to.write_all(&i.to_le_bytes())?;
    }
    Ok(())
}
