//! `FilesBeside`: the scripts, drawings and triangles that a script names, read through the opener of a shell.
use crate::drawing_to_field::drawing_to_field;
use crate::file_extension::extension;
use crate::{Shape, flatten, merged_parts};
use chordal::convert::mesh_to_field;
use chordal::implicit::Field;
use chordal::{Job, Mesh, Tolerance};
use chordal_io::font::{Letters, read_letters};
use chordal_io::{Content, FileLocation, FileOpener, Format, Frame, Limits, Warning};
use chordal_script::{FileUse, FontText, OpenedFile, ScriptFiles};
use std::cell::RefCell;

/// What was read so far.
#[derive(Default)]
pub(crate) struct FilesRead {
    /// What is to be said of them.
    pub warnings: Vec<Warning>,
    /// The frame of the first mesh that says anything.
    pub frame: Option<Frame>,
    n_bytes: u64,
}

/// Reads files beside a script.
pub(crate) struct FilesBeside<'a, 'b> {
    open: RefCell<Option<&'a mut FileOpener<'b>>>,
    limits: &'a Limits,
    read: RefCell<FilesRead>,
}

impl<'a, 'b> FilesBeside<'a, 'b> {
    pub fn new(open: Option<&'a mut FileOpener<'b>>, limits: &'a Limits) -> Self {
        Self { open: RefCell::new(open), limits, read: RefCell::default() }
    }

    pub fn into_read(self) -> FilesRead {
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
        Ok(bytes)
    }

    /// The triangles of a file in its own coordinates, all placements in one.
    fn triangles(&self, path: &str) -> Result<Mesh, String> {
        let bytes = self.bytes(path)?;
        let by_name = extension(path).and_then(Format::from_packed_extension);
        let content =
            chordal_io::unpacked(&bytes, by_name, self.limits).map_err(|error| error.to_string())?;
        let format = by_name.or_else(|| Format::sniff(&content)).filter(|format| *format != Format::Star);
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

impl ScriptFiles for FilesBeside<'_, '_> {
    fn open(&self, name: &str, wanted: FileUse, job: &Job) -> Result<OpenedFile, String> {
        match wanted {
            FileUse::Script => {
                let bytes = self.bytes(name)?;
                String::from_utf8(bytes).map(OpenedFile::Script).map_err(|_| "it is not UTF-8".to_owned())
            }
            FileUse::Drawing { tolerance } => {
                let read = chordal_io::read(&self.bytes(name)?, Format::Svg, self.limits);
                drawing(read.map_err(|error| error.to_string())?.content, tolerance, job)
            }
            FileUse::Letters(FontText { text, em, axes, tolerance }) => {
                let bytes = self.bytes(name)?;
                let content = chordal_io::unpacked(&bytes, Some(Format::Ttf), self.limits);
                let content = content.map_err(|error| error.to_string())?;
                let read = read_letters(&content, &Letters { text, em, axes }, self.limits);
                drawing(read.map_err(|error| error.to_string())?.content, tolerance, job)
            }
            FileUse::Mesh => self.mesh(name, job).map(|field| OpenedFile::Shape(field, Vec::new())),
        }
    }
}

impl FilesBeside<'_, '_> {
    fn mesh(&self, name: &str, job: &Job) -> Result<Field, String> {
        let mesh = self.triangles(name)?;
        let n_faces = mesh.faces().len() as u64;
        if n_faces > job.triangle_limit {
            return Err(format!("it has {n_faces} triangles; the limit is {}", job.triangle_limit));
        }
        let bytes = BYTES_A_TRIANGLE * n_faces;
        if bytes > job.memory_limit {
            let limit = job.memory_limit;
            return Err(format!("{n_faces} triangles take {bytes} bytes of memory; the limit is {limit}"));
        }
        let made = mesh_to_field(&mesh, job).map_err(|error| error.to_string())?;
        if !made.solid.is_solid() {
            self.read.borrow_mut().warnings.push(Warning {
                code: "mesh-not-solid",
                count: 1,
                place: FileLocation::File,
                message: format!("{name}: {}", made.solid).into(),
            });
        }
        Ok(made.field)
    }
}

/// What a drawing fills, as one shape of the plane.
fn drawing(content: Content, tolerance: f64, job: &Job) -> Result<OpenedFile, String> {
    let Content::Drawing(drawing) = content else { return Err("it is no drawing".to_owned()) };
    let tolerance = Tolerance::new(tolerance).map_err(|error| error.to_string())?;
    let (field, sentences) = drawing_to_field(&drawing, tolerance, job)?;
    Ok(OpenedFile::Shape(field, sentences))
}
