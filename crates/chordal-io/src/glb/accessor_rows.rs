//! `AccessorRows`: the rows of an accessor, decoded from their bytes.
use super::format::{AccessorFormat, ComponentType};
use super::meshopt::BROKEN_STREAM;
use super::model::{GltfModel, item};

/// The count of numbers decoded at once. Chosen: few enough for the L1 cache.
const BLOCK: usize = 1024;

/// An accessor whose bytes are all present.
pub(super) struct AccessorRows<'m> {
    pub format: AccessorFormat,
    pub count: u64,
    /// The bytes from the first row on, and the stride. If absent, the rows are zeros.
    base: Option<(&'m [u8], usize)>,
    sparse: Option<SparseRows<'m>>,
    places: [usize; 16],
}

struct SparseRows<'m> {
    count: usize,
    index_component: ComponentType,
    indices: &'m [u8],
    values: &'m [u8],
}

/// Why an accessor cannot be read: a code, and a sentence that ends "bufferView 3 has no byteLength".
pub(super) struct AccessorError {
    pub code: &'static str,
    pub what: String,
}

fn unreadable<T>(code: &'static str, what: String) -> Result<T, AccessorError> {
    Err(AccessorError { code, what })
}

impl<'m> AccessorRows<'m> {
    /// The rows of an accessor, as a borrowed view.
    ///
    /// # Errors
    /// If a field is missing or wrong, or bytes are missing.
    pub fn new(model: &'m GltfModel<'_>, accessor: usize) -> Result<Self, AccessorError> {
        let Some(object) = item(&model.accessors, Some(accessor)) else {
            return unreadable("UNRESOLVED_REFERENCE", format!("there is no accessor {accessor}"));
        };
        let (Some(format), Some(count), Some(offset)) = (object.format(), object.count, object.offset) else {
            let what = format!("accessor {accessor} has no valid type, componentType, count and byteOffset");
            return unreadable("UNDEFINED_PROPERTY", what);
        };
        let mut base = None;
        if let Some(view) = object.view {
            let stride = item(&model.views, Some(view)).and_then(|view| view.stride);
            let stride = stride.unwrap_or(format.natural_stride());
            if stride < format.row_length() {
                let what = format!("byteStride {stride} of bufferView {view} is below a row's length");
                return unreadable("ACCESSOR_SMALL_BYTESTRIDE", what);
            }
            let length = stride.saturating_mul(count - 1).saturating_add(format.row_length());
            // Strides are 252 at most, or 64 when they follow from the format.
            base = Some((bytes(model, view, offset, length)?, stride as usize));
        }
        // Data of a compressed stream takes precedence over the view, which a writer may have left
        // for readers without the decoder.
        if let Some(rows) = &object.unpacked {
            base = Some((rows, format.row_length() as usize));
        }
        // Without a view the rows are zeros, which sparse values then replace.
        let mut sparse = None;
        if let Some(rows) = &object.sparse {
            let (Some(index_component), Some(index_view), Some(value_view)) =
                (rows.index_component, rows.index_view, rows.value_view)
            else {
                return unreadable(
                    "UNDEFINED_PROPERTY",
                    format!("accessor {accessor} has no valid sparse data"),
                );
            };
            let row = format.component.size() * format.kind.n_components() as u64;
            let n_index = rows.count.saturating_mul(index_component.size());
            let n_value = rows.count.saturating_mul(row);
            sparse = Some(SparseRows {
                indices: bytes(model, index_view, rows.index_offset.unwrap_or(0), n_index)?,
                values: bytes(model, value_view, rows.value_offset.unwrap_or(0), n_value)?,
                // The values are in memory, so their count fits a usize.
                count: rows.count as usize,
                index_component,
            });
        }
        let mut places = [0; 16];
        for (k, place) in places.iter_mut().take(format.kind.n_components()).enumerate() {
            *place = format.place_of(k) as usize;
        }
        Ok(Self { format, count, base, sparse, places })
    }

    /// The bytes of all rows.
    pub fn n_bytes(&self) -> u64 {
        self.count.saturating_mul(self.format.row_length())
    }

    /// Whether any value comes from the file.
    pub fn has_data(&self) -> bool {
        self.base.is_some() || self.sparse.is_some()
    }

    /// The indices of the replaced rows.
    pub fn sparse_indices(&self) -> impl Iterator<Item = u64> {
        let n = self.sparse.as_ref().map_or(0, |sparse| sparse.count);
        (0..n).map(|i| self.sparse.as_ref().map_or(0, |sparse| sparse.index(i)))
    }

    /// Checks that sparse rows are in range and in order; otherwise it is unclear which rows they replace.
    pub fn check_sparse(&self) -> Result<(), AccessorError> {
        let mut next = 0;
        for (i, index) in self.sparse_indices().enumerate() {
            if index < next {
                let what = format!("sparse index {i} is {index}, not above the one before");
                return unreadable("ACCESSOR_SPARSE_INDICES_NON_INCREASING", what);
            }
            if index >= self.count {
                let what = format!("sparse index {i} is {index}, there are {} rows", self.count);
                return unreadable("ACCESSOR_SPARSE_INDEX_OOB", what);
            }
            next = index + 1;
        }
        Ok(())
    }

    /// Visits the rows in order, with their raw numbers.
    pub fn each(&self, mut visit: impl FnMut(u64, &[f64])) {
        let n = self.format.kind.n_components();
        self.each_block(|first, numbers| {
            (first..).zip(numbers.chunks_exact(n)).for_each(|(i, row)| visit(i, row));
        });
    }

    /// Visits the rows in order, in blocks: the index of the first row, and the raw numbers of the block.
    pub fn each_block(&self, mut visit: impl FnMut(u64, &[f64])) {
        let n = self.format.kind.n_components();
        let mut block = [0.0; BLOCK];
        let (mut first, mut next) = (0, 0);
        while first < self.count {
            let n_rows = (self.count - first).min((BLOCK / n) as u64);
            let numbers = &mut block[..n_rows as usize * n];
            self.base_rows(first, numbers);
            if let Some(sparse) = &self.sparse {
                next = sparse.replace(self.format, next, first, numbers);
            }
            visit(first, numbers);
            first += n_rows;
        }
    }

    /// One raw number.
    pub fn number(&self, row: u64, k: usize) -> f64 {
        if let Some(sparse) = &self.sparse
            && let Some(i) = sparse.find(row)
        {
            return sparse.value(self.format, i, k);
        }
        self.base_number(row, k)
    }

    /// One number, normalized if the accessor is.
    pub fn normalized(&self, row: u64, k: usize) -> f64 {
        self.decode(self.number(row, k))
    }

    /// Converts a raw number to its value.
    pub fn decode(&self, x: f64) -> f64 {
        if self.format.normalized { self.format.component.normalize(x) } else { x }
    }

    fn base_number(&self, row: u64, k: usize) -> f64 {
        let Some((bytes, stride)) = self.base else { return 0.0 };
        // Rows that passed the check in `new` are in memory.
        self.format.component.read(bytes.get(row as usize * stride + self.places[k]..).unwrap_or_default())
    }

    /// The numbers of consecutive rows from `first` on, without sparse replacements.
    fn base_rows(&self, first: u64, numbers: &mut [f64]) {
        let Some((bytes, stride)) = self.base else { return numbers.fill(0.0) };
        let (component, n) = (self.format.component, self.format.kind.n_components());
        let bytes = bytes.get(first as usize * stride..).unwrap_or_default();
        let size = component.size() as usize;
        if stride == n * size && bytes.len() >= numbers.len() * size {
            return component.read_all(bytes, numbers);
        }
        for (i, row) in numbers.chunks_exact_mut(n).enumerate() {
            for (x, place) in row.iter_mut().zip(&self.places) {
                *x = component.read(bytes.get(i * stride + place..).unwrap_or_default());
            }
        }
    }
}

impl SparseRows<'_> {
    fn index(&self, i: usize) -> u64 {
        let size = self.index_component.size() as usize;
        self.index_component.read(self.indices.get(i * size..).unwrap_or_default()) as u64
    }

    fn value(&self, format: AccessorFormat, i: usize, k: usize) -> f64 {
        let at = (i * format.kind.n_components() + k) * format.component.size() as usize;
        format.component.read(self.values.get(at..).unwrap_or_default())
    }

    /// Applies the sparse rows from `next` on that fall into `numbers`, and returns the first one beyond.
    /// `first` is the row at which the numbers begin.
    fn replace(&self, format: AccessorFormat, mut next: usize, first: u64, numbers: &mut [f64]) -> usize {
        let n = format.kind.n_components();
        while next < self.count {
            let i = self.index(next);
            let place = usize::try_from(i.saturating_sub(first)).unwrap_or(usize::MAX);
            let Some(row) = numbers.chunks_exact_mut(n).nth(place) else { break };
            row.iter_mut().enumerate().for_each(|(k, x)| *x = self.value(format, next, k));
            // Indices increase, or the file was refused; equal ones are skipped.
            while next < self.count && self.index(next) <= i {
                next += 1;
            }
        }
        next
    }

    fn find(&self, row: u64) -> Option<usize> {
        let (mut low, mut high) = (0, self.count);
        while low < high {
            let middle = low + (high - low) / 2;
            if self.index(middle) < row { low = middle + 1 } else { high = middle }
        }
        (low < self.count && self.index(low) == row).then_some(low)
    }
}

/// The bytes of a view from an offset on, at least as many as requested.
fn bytes<'m>(
    model: &'m GltfModel<'_>,
    view: usize,
    offset: u64,
    length: u64,
) -> Result<&'m [u8], AccessorError> {
    let Some(object) = item(&model.views, Some(view)) else {
        return unreadable("UNRESOLVED_REFERENCE", format!("there is no bufferView {view}"));
    };
    let (Some(start), Some(n_view), Some(buffer)) = (object.offset, object.length, object.buffer) else {
        let what = format!("bufferView {view} has no valid buffer, byteOffset and byteLength");
        return unreadable("UNDEFINED_PROPERTY", what);
    };
    let end = offset.saturating_add(length);
    if end > n_view {
        let what = format!("the rows end at byte {end} of bufferView {view}, which has {n_view}");
        return unreadable("ACCESSOR_TOO_LONG", what);
    }
    let (data, start, owner) = match &object.packed {
        None => (buffer_data(model, buffer)?, start, format!("buffer {buffer}")),
        Some(packed) => match (&packed.bytes, &packed.layout) {
            (Some(bytes), _) => (bytes.as_slice(), 0, "its unpacked data".to_owned()),
            (None, layout) => {
                // Reports a missing buffer of the compressed stream.
                layout.map(|layout| buffer_data(model, layout.buffer)).transpose()?;
                let what = format!("bufferView {view} by {} could not be unpacked", packed.extension);
                return unreadable(BROKEN_STREAM, what);
            }
        },
    };
    let range = usize::try_from(start.saturating_add(offset)).ok().and_then(|start| {
        let rest = data.get(start..)?;
        (rest.len() as u64 >= length).then_some(rest)
    });
    match range {
        Some(rest) => Ok(rest),
        None => {
            let what = format!("bufferView {view} exceeds the {} bytes of {owner}", data.len());
            unreadable("BUFFER_VIEW_TOO_LONG", what)
        }
    }
}

/// The bytes of a buffer.
fn buffer_data<'m>(model: &'m GltfModel<'_>, buffer: usize) -> Result<&'m [u8], AccessorError> {
    let Some(source) = item(&model.buffers, Some(buffer)) else {
        return unreadable("UNRESOLVED_REFERENCE", format!("there is no buffer {buffer}"));
    };
    source.data.as_deref().ok_or_else(|| AccessorError {
        code: "external-buffer",
        what: match source.uri {
            Some(uri) if uri.contains("://") => format!("buffer {buffer} is {uri:?}: no network"),
            Some(uri) => {
                format!("buffer {buffer} is in another file, {uri:?}, and no other file was opened")
            }
            None => format!("buffer {buffer} has no data"),
        },
    })
}

#[cfg(test)]
mod tests {
    use super::super::format::AccessorType;
    use super::*;
    use chordal_testkit::Random;

    #[test]
    fn rows_in_order_are_those_one_by_one() {
        let mut random = Random::new(5);
        let kinds = [AccessorType::Scalar, AccessorType::Vec2, AccessorType::Vec3, AccessorType::Mat3];
        let components = [ComponentType::I8, ComponentType::U16, ComponentType::U32, ComponentType::F32];
        for i in 0..200_usize {
            let format = AccessorFormat::plain(kinds[i % 4], components[i / 4 % 4]);
            let n = format.kind.n_components();
            let (count, stride) = (1 + random.below(2000), format.natural_stride() as usize + 4 * (i % 3));
            let mut bytes = |n: usize| (0..n).map(|_| random.below(256) as u8).collect::<Vec<u8>>();
            let (base, values) = (bytes(count * stride), bytes(count * n * 4));
            let replaced: Vec<u16> = (0..count as u16).filter(|_| random.below(50) == 0).collect();
            let indices: Vec<u8> = replaced.iter().flat_map(|row| row.to_le_bytes()).collect();
            let sparse = SparseRows {
                count: replaced.len(),
                index_component: ComponentType::U16,
                indices: &indices,
                values: &values,
            };
            let mut places = [0; 16];
            (0..n).for_each(|k| places[k] = format.place_of(k) as usize);
            let rows = AccessorRows {
                format,
                count: count as u64,
                base: (i % 5 > 0).then_some((&base[..], stride)),
                sparse: (i % 2 > 0).then_some(sparse),
                places,
            };
            let mut next = 0;
            rows.each(|row, numbers| {
                assert_eq!(row, next);
                next += 1;
                let one_by_one = (0..n).map(|k| rows.number(row, k).to_bits());
                assert!(numbers.iter().map(|x| x.to_bits()).eq(one_by_one), "row {row} of {format}");
            });
            assert_eq!(next, rows.count);
        }
    }
}
