//! `LegacyArrays`: the data of points or cells in a legacy VTK file, by the keywords of its attributes.
use super::attributes::{ArrayRole, ArrayRows, NamedArray, skip_array};
use super::legacy_reader::{LegacyReader, LegacyType, lower};
use crate::ReadError;
use crate::text::{is_space, show};
use crate::volume::element::SampleType;
use crate::warnings::Warnings;

/// A consumer of arrays; the number is the limit on values that are copied to triangles.
type ArraySink<'s> = dyn FnMut(&NamedArray<'_>, u64, &mut Warnings) -> Result<(), ReadError> + 's;

/// Reads arrays.
pub(super) struct LegacyArrays<'r, 'a> {
    pub reader: &'r mut LegacyReader<'a>,
    pub warnings: &'r mut Warnings,
    /// The name of the first array that the file declares as scalars.
    pub first_scalars: Option<String>,
}

/// An array as declared by its line.
struct ArrayLine {
    name: String,
    role: ArrayRole,
    kind: LegacyType,
    n: u64,
    width: u64,
}

impl<'r, 'a> LegacyArrays<'r, 'a> {
    pub(super) fn new(reader: &'r mut LegacyReader<'a>, warnings: &'r mut Warnings) -> Self {
        Self { reader, warnings, first_scalars: None }
    }

    /// Reads the arrays of these rows.
    ///
    /// # Errors
    /// At the line or the byte, for an unknown keyword, truncated data or an invalid number; and errors of
    /// `sink`.
    pub(super) fn read(
        &mut self,
        rows: ArrayRows<'_>,
        most_spread: u64,
        sink: &mut ArraySink<'_>,
    ) -> Result<(), ReadError> {
        let (ArrayRows::Points(n) | ArrayRows::Cells(n, _)) = rows;
        let n = n as u64;
        while let Some(word) = self.reader.peek() {
            let keyword = lower(word);
            if matches!(&*keyword, "point_data" | "cell_data") {
                return Ok(());
            }
            self.reader.next();
            let line = match &*keyword {
                "metadata" => {
                    self.skip_metadata()?;
                    continue;
                }
                "lookup_table" => {
                    self.skip_table()?;
                    continue;
                }
                "field" => {
                    self.field(n, most_spread, sink)?;
                    continue;
                }
                "scalars" => self.scalars(n)?,
                "color_scalars" => self.colors(n)?,
                "vectors" => self.fixed(n, 3, ArrayRole::Unknown)?,
                "normals" => self.fixed(n, 3, ArrayRole::Normals)?,
                "tensors" => self.fixed(n, 9, ArrayRole::Unknown)?,
                "tensors6" => self.fixed(n, 6, ArrayRole::Unknown)?,
                "global_ids" | "pedigree_ids" | "edge_flags" => self.fixed(n, 1, ArrayRole::Unknown)?,
                "texture_coordinates" => {
                    let name = self.reader.name("the name of an array")?;
                    let width = self.reader.count("the number of coordinates")?;
                    let kind = self.reader.kind()?;
                    ArrayLine { name, role: ArrayRole::TexCoords, kind, n, width }
                }
                _ => {
                    let message = format!("{} is no keyword of VTK here", show(word));
                    return Err(self.reader.error("unknown-keyword", message));
                }
            };
            self.array(&line, n, most_spread, sink)?;
        }
        Ok(())
    }

    /// An array whose keyword implies its width.
    fn fixed(&mut self, n: u64, width: u64, role: ArrayRole) -> Result<ArrayLine, ReadError> {
        let name = self.reader.name("the name of an array")?;
        let kind = self.reader.kind()?;
        Ok(ArrayLine { name, role, kind, n, width })
    }

    fn scalars(&mut self, n: u64) -> Result<ArrayLine, ReadError> {
        let name = self.reader.name("the name of an array")?;
        self.first_scalars.get_or_insert_with(|| name.clone());
        let kind = self.reader.kind()?;
        let width =
            if self.reader.line_goes_on() { self.reader.count("the number of components")? } else { 1 };
        if self.reader.peek().is_some_and(|word| word.eq_ignore_ascii_case(b"lookup_table")) {
            self.reader.next();
            self.reader.word("the name of a lookup table")?;
        }
        Ok(ArrayLine { name, role: ArrayRole::Unknown, kind, n, width })
    }

    /// Colours: bytes in a binary file, fractions in text.
    fn colors(&mut self, n: u64) -> Result<ArrayLine, ReadError> {
        let name = self.reader.name("the name of an array")?;
        let width = self.reader.count("the number of channels")?;
        let kind = if self.reader.is_binary { SampleType::U8 } else { SampleType::F32 };
        Ok(ArrayLine { name, role: ArrayRole::Colors, kind: LegacyType::Number(kind), n, width })
    }

    /// Passes an array of `rows` rows to the sink, or skips it.
    fn array(
        &mut self,
        line: &ArrayLine,
        rows: u64,
        most_spread: u64,
        sink: &mut ArraySink<'_>,
    ) -> Result<(), ReadError> {
        let place = self.reader.place();
        let LegacyType::Number(kind) = line.kind else {
            skip_array(&line.name, "it holds no numbers of whole bytes", place, self.warnings);
            return self.reader.skip(line.n, line.width, line.kind);
        };
        if line.n != rows {
            skip_array(&line.name, "it has another number of rows", place, self.warnings);
            return self.reader.skip(line.n, line.width, line.kind);
        }
        let numbers = self.reader.numbers(line.n, line.width, kind)?;
        let is_bytes = kind == SampleType::U8;
        let width = usize::try_from(line.width).unwrap_or(usize::MAX);
        // Viewers show three or four bytes as a colour, whatever the name of the array.
        let is_color = line.role == ArrayRole::Unknown && is_bytes && matches!(width, 3 | 4);
        let role = if is_color { ArrayRole::Colors } else { line.role };
        let divisor = if is_bytes { 255.0 } else { 1.0 };
        let array = NamedArray { name: &line.name, role, width, kind, divisor, numbers, place };
        sink(&array, most_spread, self.warnings)
    }

    /// The arrays of a field, each with a separate line.
    fn field(&mut self, rows: u64, most_spread: u64, sink: &mut ArraySink<'_>) -> Result<(), ReadError> {
        self.reader.name("the name of a field")?;
        let n_arrays = self.reader.count("the number of arrays")?;
        for _ in 0..n_arrays {
            let line = self.field_line()?;
            self.array(&line, rows, most_spread, sink)?;
        }
        Ok(())
    }

    fn field_line(&mut self) -> Result<ArrayLine, ReadError> {
        while self.reader.peek().is_some_and(|word| word.eq_ignore_ascii_case(b"metadata")) {
            self.reader.next();
            self.skip_metadata()?;
        }
        let name = self.reader.name("the name of an array")?;
        let width = self.reader.count("the number of components")?;
        let n = self.reader.count("the number of rows")?;
        let kind = self.reader.kind()?;
        Ok(ArrayLine { name, role: ArrayRole::Unknown, kind, n, width })
    }

    /// Skips a field of the file as a whole.
    pub(super) fn skip_field(&mut self) -> Result<(), ReadError> {
        self.reader.name("the name of a field")?;
        let n_arrays = self.reader.count("the number of arrays")?;
        for _ in 0..n_arrays {
            let line = self.field_line()?;
            let why = "it belongs to no point and no cell";
            skip_array(&line.name, why, self.reader.place(), self.warnings);
            self.reader.skip(line.n, line.width, line.kind)?;
        }
        Ok(())
    }

    /// Skips the metadata of an array, which ends with a blank line.
    pub(super) fn skip_metadata(&mut self) -> Result<(), ReadError> {
        self.reader.end_line();
        while self.reader.peek().is_some() {
            if self.reader.line()?.iter().all(|b| is_space(*b)) {
                break;
            }
        }
        Ok(())
    }

    /// Skips a lookup table: four bytes per colour in a binary file, four fractions in text.
    fn skip_table(&mut self) -> Result<(), ReadError> {
        let name = self.reader.name("the name of a lookup table")?;
        let n = self.reader.count("the size of a lookup table")?;
        self.warnings.count("lookup-tables-skipped", || {
            let message = format!("lookup tables were skipped, {} first", show(name.as_bytes()));
            (self.reader.place().location(), message)
        });
        let kind = if self.reader.is_binary { SampleType::U8 } else { SampleType::F32 };
        self.reader.skip(n, 4, LegacyType::Number(kind))
    }
}
