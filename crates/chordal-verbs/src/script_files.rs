//! `MeshFiles`: the triangles that a script names, read through the opener of a shell.
use crate::digest::sha256;
use crate::file_extension::extension;
use crate::{FormatHint, InputFile, Shape, flatten, merged_parts};
use chordal::convert::mesh_to_field;
use chordal::implicit::Field;
use chordal::{Job, Mesh};
use chordal_io::{FileLocation, FileOpener, Format, Frame, Limits, Warning};
use chordal_script::ShapeFiles;
use std::cell::RefCell;

/// What was read so far.
#[derive(Default)]
pub(crate) struct ReadMeshes {
    /// The files, in the order of reading.
    pub files: Vec<InputFile>,
    /// What is to be said of them.
    pub warnings: Vec<Warning>,
    /// The frame of the first one that says anything.
    pub frame: Option<Frame>,
    n_bytes: u64,
}

/// Reads meshes beside a script.
pub(crate) struct MeshFiles<'a, 'b> {
    open: RefCell<Option<&'a mut FileOpener<'b>>>,
    limits: &'a Limits,
    read: RefCell<ReadMeshes>,
}

impl<'a, 'b> MeshFiles<'a, 'b> {
    pub fn new(open: Option<&'a mut FileOpener<'b>>, limits: &'a Limits) -> Self {
        Self { open: RefCell::new(open), limits, read: RefCell::default() }
    }

    pub fn into_read(self) -> ReadMeshes {
        self.read.into_inner()
    }

    /// The bytes of a file; all files together are limited like one.
    fn bytes(&self, path: &str) -> Result<Vec<u8>, String> {
        let mut open = self.open.borrow_mut();
        let open = open.as_mut().ok_or_else(|| "there are no files beside this script".to_owned())?;
        let bytes = open(path)?;
        let mut read = self.read.borrow_mut();
        read.n_bytes = read.n_bytes.saturating_add(bytes.len() as u64);
        if read.n_bytes > self.limits.bytes {
            return Err(format!("the files of the script have more than {} bytes", self.limits.bytes));
        }
        let n_bytes = bytes.len() as u64;
        read.files.push(InputFile { path: path.to_owned(), n_bytes, sha256: sha256(&bytes) });
        Ok(bytes)
    }

    /// The triangles of a file in its own coordinates, all placements in one.
    fn triangles(&self, path: &str) -> Result<Mesh, String> {
        let bytes = self.bytes(path)?;
        let by_name = extension(path).and_then(Format::from_packed_extension);
        let content =
            chordal_io::unpacked(&bytes, by_name, self.limits).map_err(|error| error.to_string())?;
        let hint = FormatHint { name: Some(path), ..FormatHint::default() };
        let format = hint.format_of(&content).filter(|format| *format != Format::Star);
        let format = format.ok_or_else(|| "this is no file of triangles".to_owned())?;
        // Polygons are taken as their triangles.
        let limits = Limits { surface: None, ..*self.limits };
        let loaded = chordal_io::read(&content, format, &limits).map_err(|error| error.to_string())?;
        let Shape::Scene(scene) = Shape::from(loaded.content) else {
            return Err(format!("this {format} holds no triangles: mesh it first"));
        };
        let frame = scene.frame;
        let placed = flatten::flatten(scene).map_err(|error| error.to_string())?;
        let mut read = self.read.borrow_mut();
        let warn = |code: &'static str, what: String| Warning {
            code,
            count: 1,
            place: FileLocation::File,
            message: format!("{path}: {what}").into(),
        };
        let told: Vec<Warning> = loaded
            .warnings
            .iter()
            .map(|warning| Warning { count: warning.count, ..warn(warning.code, warning.to_string()) })
            .collect();
        read.warnings.extend(told);
        if placed.moved_at_most > 0.0 {
            let what = format!("placing its parts rounded corners by up to {:e}", placed.moved_at_most);
            read.warnings.push(warn("placements-rounded", what));
        }
        match read.frame {
            Some(known) if known != frame => {
                let what = "its unit or its axes are others than those of the first mesh: coordinates are taken as they are";
                read.warnings.push(warn("frames-differ", what.to_owned()));
            }
            Some(_) => {}
            None => read.frame = Some(frame),
        }
        let mesh = merged_parts::one_mesh(&placed.scene).map_err(|error| error.to_string())?.into_owned();
        if mesh.faces().is_empty() {
            return Err("it has no triangles".to_owned());
        }
        Ok(mesh)
    }
}

/// Bytes for each triangle of a mesh as a field, at most: its boxes, moments, corners and its own copy.
/// Measured: a tree and its moments take 160.
const BYTES_A_TRIANGLE: u64 = 400;

impl ShapeFiles for MeshFiles<'_, '_> {
    fn mesh(&self, name: &str, job: &Job) -> Result<Field, String> {
        let in_file = |why: String| format!("{name}: {why}");
        let path = below_folder(name).map_err(in_file)?;
        let mesh = self.triangles(&path).map_err(in_file)?;
        let n_faces = mesh.faces().len() as u64;
        if n_faces > job.triangle_limit {
            return Err(in_file(format!("it has {n_faces} triangles; the limit is {}", job.triangle_limit)));
        }
        let bytes = BYTES_A_TRIANGLE * n_faces;
        if bytes > job.memory_limit {
            let limit = job.memory_limit;
            return Err(in_file(format!(
                "{n_faces} triangles take {bytes} bytes of memory; the limit is {limit}"
            )));
        }
        let made = mesh_to_field(&mesh, job).map_err(|error| in_file(error.to_string()))?;
        if !made.solid.is_solid() {
            self.read.borrow_mut().warnings.push(Warning {
                code: "mesh-not-solid",
                count: 1,
                place: FileLocation::File,
                message: format!("{path}: {}", made.solid).into(),
            });
        }
        Ok(made.field)
    }
}

/// The path below a folder that a name means: `/` or `\\` separates, and nothing leads out.
fn below_folder(name: &str) -> Result<String, String> {
    let name = name.replace('\\', "/");
    if name.starts_with('/') || name.split('/').next().is_some_and(|first| first.contains(':')) {
        return Err("only names below the folder of the script are read".to_owned());
    }
    let parts: Vec<&str> = name.split('/').filter(|part| !part.is_empty() && *part != ".").collect();
    if parts.contains(&"..") {
        return Err("this leads out of the folder of the script".to_owned());
    }
    if parts.is_empty() || name.contains('\0') {
        return Err("this names no file".to_owned());
    }
    Ok(parts.join("/"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_stay_below_the_folder() {
        assert_eq!(below_folder("a.stl").as_deref(), Ok("a.stl"));
        assert_eq!(below_folder("./parts//a b.stl").as_deref(), Ok("parts/a b.stl"));
        assert_eq!(below_folder("parts\\a.stl").as_deref(), Ok("parts/a.stl"));
        for bad in [
            "/etc/passwd",
            "\\\\host\\a.stl",
            "c:/a.stl",
            "http://x/a.stl",
            "../a.stl",
            "a/../../b",
            "",
            ".",
            "a\0",
        ] {
            assert!(below_folder(bad).is_err(), "{bad}");
        }
    }
}
