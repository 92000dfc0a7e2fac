//! Rules for accessors: their fields, and whether they fit their views.
use super::buffers::{BufferViewUse, UseTable};
use super::extensions::ExtensionHost;
use super::{ANY, GltfLint, IntegerRule};
use crate::glb::format::{AccessorType, ComponentType};
use crate::glb::json::JsonValue;
use crate::glb::model::{GltfAccessor, GltfBufferView, GltfModel, GltfSparse, item};

/// The codes of component types.
const COMPONENTS: &[u64] = &[5120, 5121, 5122, 5123, 5125, 5126];

/// A run of rows that must lie inside a view.
struct ViewRange {
    view: usize,
    offset: u64,
    /// Bytes per component; offsets are multiples of it.
    align: u64,
    length: u64,
}

impl<'a> GltfLint<'a> {
    pub(super) fn accessor(&mut self, map: &'a JsonValue) -> GltfAccessor {
        let view = self.index(map, "bufferView", false);
        let offset = if view.is_none() {
            if map.get("byteOffset").is_some() {
                self.issue_below("UNSATISFIED_DEPENDENCY", "byteOffset", "bufferView is missing");
            }
            Some(0)
        } else {
            self.integer(map, "byteOffset", IntegerRule::default()).or(0)
        };
        let component = self.integer(
            map,
            "componentType",
            IntegerRule { list: COMPONENTS, required: true, ..IntegerRule::default() },
        );
        let component = component.value().and_then(ComponentType::from_code);
        let count = self
            .integer(map, "count", IntegerRule { min: 1, required: true, ..IntegerRule::default() })
            .value();
        let kind = self.text(map, "type", true).and_then(AccessorType::from_name);
        let normalized = self.flag(map, "normalized");
        let (mut min, mut max) = (None, None);
        if let (Some(kind), Some(component)) = (kind, component) {
            min = self.bounds(map, "min", kind, component);
            max = self.bounds(map, "max", kind, component);
        }
        let sparse = self.object(map, "sparse", false);
        let sparse =
            sparse.and_then(|sparse| self.within("sparse", |lint| lint.sparse(sparse))).map(Box::new);
        if normalized && matches!(component, Some(ComponentType::F32 | ComponentType::U32)) {
            self.issue_below(
                "ACCESSOR_NORMALIZED_INVALID",
                "normalized",
                "only bytes and shorts can be normalized",
            );
        }
        if kind.is_some_and(AccessorType::is_matrix) && offset.is_some_and(|offset| offset % 4 != 0) {
            self.issue_below(
                "ACCESSOR_MATRIX_ALIGNMENT",
                "byteOffset",
                "matrices begin at multiples of 4 bytes",
            );
        }
        self.name(map);
        self.extensions(map, ExtensionHost::Other);
        GltfAccessor { view, offset, count, component, kind, normalized, min, max, sparse, unpacked: None }
    }

    /// The minimum or maximum values: single-precision numbers, or integers within the range of the type.
    #[allow(clippy::cast_possible_truncation)]
    fn bounds(
        &mut self,
        map: &'a JsonValue,
        key: &'a str,
        kind: AccessorType,
        component: ComponentType,
    ) -> Option<Box<[f64]>> {
        let length = kind.n_components();
        if component == ComponentType::F32 {
            // The rows are single-precision numbers, and the bounds are compared with them exactly.
            let bounds = self.numbers(map, key, length, ANY)?;
            return Some(bounds.into_iter().map(|x| f64::from(x as f32)).collect());
        }
        let value = self.value(map, key, "array")?;
        let Some(items) = value.items() else {
            self.mismatch(key, "array");
            return None;
        };
        if items.len() != length {
            let what = format!("{key} has {} numbers where {length} are needed", items.len());
            self.issue("ARRAY_LENGTH_NOT_IN_LIST", Some(key.into()), || what);
            return None;
        }
        let (low, high) = component.range();
        let mut out = Vec::with_capacity(length);
        for x in items {
            match (x.integer(), x.number()) {
                (Some(_), Some(x)) if (low..=high).contains(&x) => out.push(x),
                (Some(_), x) => {
                    let x = x.unwrap_or_default();
                    self.issue("INVALID_GL_VALUE", Some(key.into()), || {
                        format!("{component:?} cannot hold {x}")
                    });
                }
                (None, _) => self.issue_below("ARRAY_TYPE_MISMATCH", key, "an item is no integer"),
            }
        }
        (out.len() == length).then(|| out.into())
    }

    fn sparse(&mut self, map: &'a JsonValue) -> Option<GltfSparse> {
        let count = self
            .integer(map, "count", IntegerRule { min: 1, required: true, ..IntegerRule::default() })
            .value();
        let indices = self.object(map, "indices", true);
        let indices = indices.map(|indices| self.within("indices", |lint| lint.sparse_indices(indices)));
        let values = self.object(map, "values", true);
        let values = values.map(|values| {
            self.within("values", |lint| {
                lint.extensions(values, ExtensionHost::Other);
                let view = lint.index(values, "bufferView", true);
                (view, lint.integer(values, "byteOffset", IntegerRule::default()).or(0))
            })
        });
        self.extensions(map, ExtensionHost::Other);
        let (index_view, index_offset, index_component) = indices?;
        let (value_view, value_offset) = values?;
        Some(GltfSparse {
            count: count?,
            index_view,
            index_offset,
            index_component,
            value_view,
            value_offset,
        })
    }

    fn sparse_indices(&mut self, map: &'a JsonValue) -> (Option<usize>, Option<u64>, Option<ComponentType>) {
        self.extensions(map, ExtensionHost::Other);
        let view = self.index(map, "bufferView", true);
        let offset = self.integer(map, "byteOffset", IntegerRule::default()).or(0);
        let rule = IntegerRule { list: &[5121, 5123, 5125], required: true, ..IntegerRule::default() };
        (view, offset, self.integer(map, "componentType", rule).value().and_then(ComponentType::from_code))
    }

    pub(super) fn link_accessors(&mut self, model: &GltfModel<'_>, uses: &mut UseTable) {
        for (i, accessor) in model.accessors.iter().enumerate() {
            let Some(accessor) = accessor else { continue };
            self.within("accessors", |lint| {
                lint.within(i, |lint| {
                    lint.link_rows(model, accessor);
                    if let Some(sparse) = &accessor.sparse {
                        lint.within("sparse", |lint| lint.link_sparse(model, accessor, sparse, &mut *uses));
                    }
                });
            });
        }
    }

    fn link_rows(&mut self, model: &GltfModel<'_>, accessor: &GltfAccessor) {
        let (Some(view), Some(count), Some(format)) = (accessor.view, accessor.count, accessor.format())
        else {
            return;
        };
        if !self.resolved("bufferViews", view, "bufferView".into()) {
            return;
        }
        let declared = item(&model.views, Some(view)).and_then(|view| view.stride);
        if let Some(stride) = declared.filter(|stride| *stride < format.row_length()) {
            let length = format.row_length();
            self.issue("ACCESSOR_SMALL_BYTESTRIDE", None, || {
                format!("byteStride {stride} is below {length}")
            });
        }
        let stride = declared.unwrap_or(format.natural_stride());
        let length = stride.saturating_mul(count - 1).saturating_add(format.row_length());
        let Some(offset) = accessor.offset else { return };
        self.fits(model, &ViewRange { view, offset, align: format.component.size(), length });
    }

    fn link_sparse(
        &mut self,
        model: &GltfModel<'_>,
        accessor: &GltfAccessor,
        sparse: &GltfSparse,
        uses: &mut UseTable,
    ) {
        let (Some(count), Some(format)) = (accessor.count, accessor.format()) else { return };
        if sparse.count > count {
            let what = format!("{} rows are replaced of {count}", sparse.count);
            self.issue("ACCESSOR_SPARSE_COUNT_OUT_OF_RANGE", Some("count".into()), || what);
        }
        let size = format.component.size();
        let row = size * format.kind.n_components() as u64;
        // Alignment and bytes of a row: indices have one number, values as many as the accessor,
        // each aligned.
        let index = sparse.index_component.map(|component| (component.size(), component.size()));
        let runs = [
            ("indices", sparse.index_view, sparse.index_offset, index),
            ("values", sparse.value_view, sparse.value_offset, Some((size, row))),
        ];
        for (key, view, offset, sizes) in runs {
            let Some(view) = view else { continue };
            self.within(key, |lint| {
                if !lint.resolved("bufferViews", view, "bufferView".into()) {
                    return;
                }
                lint.use_view(uses, Some(view), BufferViewUse::Other, "bufferView");
                if item(&model.views, Some(view)).is_some_and(|view| view.stride.is_some()) {
                    lint.issue_below(
                        "BUFFER_VIEW_INVALID_BYTE_STRIDE",
                        "bufferView",
                        "sparse data have no byteStride",
                    );
                }
                if let (Some((align, row)), Some(offset)) = (sizes, offset) {
                    lint.fits(
                        model,
                        &ViewRange { view, offset, align, length: row.saturating_mul(sparse.count) },
                    );
                }
            });
        }
    }

    /// Checks that a run is aligned and lies inside its view.
    fn fits(&mut self, model: &GltfModel<'_>, run: &ViewRange) {
        let Some(GltfBufferView { offset: start, length, .. }) = item(&model.views, Some(run.view)) else {
            return;
        };
        let ViewRange { view, offset, align, .. } = *run;
        if offset % align != 0 {
            self.issue("ACCESSOR_OFFSET_ALIGNMENT", Some("byteOffset".into()), || {
                format!("byteOffset {offset} is no multiple of {align}")
            });
        }
        let Some(start) = *start else { return };
        let total = start.saturating_add(offset);
        if total % align != 0 {
            self.issue("ACCESSOR_TOTAL_OFFSET_ALIGNMENT", None, || {
                format!("the offset {total} in the buffer is no multiple of {align}")
            });
        }
        let length = length.unwrap_or(0);
        let end = offset.saturating_add(run.length);
        if end > length {
            let below = if offset > length { Some("byteOffset".into()) } else { None };
            self.issue("ACCESSOR_TOO_LONG", below, || {
                format!("the rows end at byte {end} of bufferView {view}, which has {length}")
            });
        }
    }
}
