//! `FilesBeside`: the scripts, drawings and triangles that a script names, read through the opener of a front end.
use super::drawing_to_field::drawing_to_field;
use super::file_extension::extension;
use super::heights_to_mesh::{HeightSolid, heights_to_mesh};
use super::scene_to_field::scene_to_field;
use crate::Shape;
use chordal::implicit::Field;
use chordal::{Job, Tolerance};
use chordal_io::font::{Letters, read_letters};
use chordal_io::png::Greys;
use chordal_io::{Content, FileLocation, FileOpener, Format, Frame, Limits, Scene, Warning};
use chordal_script::{FileUse, FontText, OpenedFile, ScriptFiles};
use std::cell::RefCell;

/// The files that were read so far.
#[derive(Default)]
pub(crate) struct FilesRead {
    /// The warnings about them.
    pub warnings: Vec<Warning>,
    /// The frame of the first mesh that has one.
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

    /// The distance to the triangles of a file, in its own coordinates.
    fn mesh(&self, path: &str, job: &Job) -> Result<Field, String> {
        let bytes = self.bytes(path)?;
        let by_name = extension(path).and_then(Format::from_packed_extension);
        let content =
            chordal_io::unpacked(&bytes, by_name, self.limits).map_err(|error| error.to_string())?;
        let format = by_name.or_else(|| Format::sniff(&content)).filter(|format| !format.is_script());
        let format = format.ok_or_else(|| "this is not a file of triangles".to_owned())?;
        // Polygons are taken as their triangles.
        let limits = Limits { surface: None, ..*self.limits };
        let loaded = chordal_io::read(&content, format, &limits).map_err(|error| error.to_string())?;
        let Shape::Scene(scene) = Shape::from(loaded.content) else {
            return Err(format!("this {format} holds no triangles: mesh it first"));
        };
        let frame = scene.frame;
        let converted = scene_to_field(scene, job).map_err(|error| error.to_string())?;
        let mut read = self.read.borrow_mut();
        let warn = |code: &'static str, what: String| Warning {
            code,
            count: 1,
            place: FileLocation::File,
            message: format!("{path}: {what}").into(),
        };
        let warnings: Vec<Warning> = loaded
            .warnings
            .iter()
            .map(|warning| Warning { count: warning.count, ..warn(warning.code, warning.to_string()) })
            .collect();
        read.warnings.extend(warnings);
        read.warnings.extend(converted.notes.into_iter().map(|(code, what)| warn(code, what)));
        match read.frame {
            Some(first) if first != frame => {
                let what = "its unit or its axes differ from those of the first mesh: coordinates are taken as they are";
                read.warnings.push(warn("frames-differ", what.to_owned()));
            }
            Some(_) => {}
            None => read.frame = Some(frame),
        }
        Ok(converted.field)
    }
}

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
            FileUse::Letters(FontText { text, em, axes, tolerance, align }) => {
                let bytes = self.bytes(name)?;
                let content = chordal_io::unpacked(&bytes, Some(Format::Ttf), self.limits);
                let content = content.map_err(|error| error.to_string())?;
                let read = read_letters(&content, &Letters { text, em, axes, align }, self.limits);
                drawing(read.map_err(|error| error.to_string())?.content, tolerance, job)
            }
            FileUse::Mesh => self.mesh(name, job).map(|field| OpenedFile::Shape(field, Vec::new())),
            FileUse::Heights { size, height, base } => {
                let read = chordal_io::png::read_greys(&self.bytes(name)?, self.limits);
                let greys = read.map_err(|error| error.to_string())?;
                heights(&greys, HeightSolid { size, height, base }, job)
            }
        }
    }
}

/// The filled regions of a drawing, as one shape of the plane.
fn drawing(content: Content, tolerance: f64, job: &Job) -> Result<OpenedFile, String> {
    let Content::Drawing(drawing) = content else { return Err("it is not a drawing".to_owned()) };
    let tolerance = Tolerance::new(tolerance).map_err(|error| error.to_string())?;
    let (field, sentences) = drawing_to_field(&drawing, tolerance, job)?;
    Ok(OpenedFile::Shape(field, sentences))
}

/// The solid below the greys of a picture, as exact triangles. The top of the picture has the highest y.
fn heights(greys: &Greys, solid: HeightSolid, job: &Job) -> Result<OpenedFile, String> {
    let (columns, rows) = (greys.width, greys.height);
    if columns < 2 || rows < 2 {
        return Err(format!("heights are at least 2 pixels each way, and it has {columns} by {rows}"));
    }
    let upwards: Vec<f64> = greys.values.chunks(columns as usize).rev().flatten().copied().collect();
    let mesh = heights_to_mesh(&upwards, [columns, rows], solid).map_err(|error| error.to_string())?;
    let converted = scene_to_field(Scene::from_mesh("heights", mesh, Frame::default()), job);
    let converted = converted.map_err(|error| error.to_string())?;
    let notes = converted.notes.into_iter().map(|(_, note)| note).collect();
    Ok(OpenedFile::Shape(converted.field, notes))
}
