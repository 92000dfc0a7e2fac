//! Rules for views compressed by `EXT_meshopt_compression` or `KHR_meshopt_compression`, and for their
//! fallback buffers. The validator does not know these extensions: the rules are those of their
//! specifications.
use super::{GltfLint, IntegerRule};
use crate::glb::json::JsonValue;
use crate::glb::meshopt::{MeshoptFilter, MeshoptLayout, MeshoptMode, NAMES};
use crate::glb::model::{GltfBufferView, GltfModel, GltfPackedView, item};

/// A required whole number of at least 1.
const COUNTED: IntegerRule = IntegerRule { min: 1, max: None, list: &[], required: true };

/// The code of a view that must, or must not, be compressed because of its buffer.
const FALLBACK: &str = "meshopt-fallback";

impl<'a> GltfLint<'a> {
    /// Whether a buffer exists only for readers that cannot decode the compressed views on it.
    pub(super) fn is_fallback(&mut self, map: &'a JsonValue) -> bool {
        let extensions = map.get("extensions");
        self.within("extensions", |lint| {
            let mut marked = false;
            for name in NAMES {
                if let Some(value) = extensions.and_then(|map| map.get(name)) {
                    marked |= lint.within(name, |lint| lint.flag(value, "fallback"));
                }
            }
            marked
        })
    }

    /// The compression of a view, if it has any.
    pub(super) fn packed_view(
        &mut self,
        map: &'a JsonValue,
        view: &GltfBufferView,
    ) -> Option<Box<GltfPackedView>> {
        let extensions = map.get("extensions")?;
        let mut compressions = NAMES.into_iter().filter_map(|name| Some((name, extensions.get(name)?)));
        let (extension, value) = compressions.next()?;
        self.within("extensions", |lint| {
            if let Some((second, _)) = compressions.next() {
                let what = "a view is compressed by one extension and not by two";
                lint.issue_below("UNEXPECTED_EXTENSION_OBJECT", second, what);
            }
            lint.within(extension, |lint| {
                // All extensions were already checked to be objects.
                let is_object = matches!(value, JsonValue::Object(_));
                let layout = if is_object { lint.packed_layout(value) } else { None };
                let layout = layout.filter(|layout| lint.packed_rules(extension, layout, view));
                Some(Box::new(GltfPackedView { extension, layout, bytes: None }))
            })
        })
    }

    fn packed_layout(&mut self, map: &'a JsonValue) -> Option<MeshoptLayout> {
        let buffer = self.index(map, "buffer", true);
        let offset = self.integer(map, "byteOffset", IntegerRule::default()).or(0);
        let length = self.integer(map, "byteLength", COUNTED).value();
        let stride = self.integer(map, "byteStride", COUNTED).value();
        let count = self.integer(map, "count", COUNTED).value();
        let mode = self.text(map, "mode", true);
        let filter = match self.text(map, "filter", false) {
            // A missing member means none; a member that is not a string is an issue.
            None if map.get("filter").is_some() => None,
            filter => Some(filter.unwrap_or("NONE")),
        };
        let mode = self.one_of("mode", mode, MeshoptMode::from_name);
        let filter = self.one_of("filter", filter, MeshoptFilter::from_name);
        Some(MeshoptLayout {
            buffer: buffer?,
            offset: offset?,
            length: length?,
            stride: stride?,
            count: count?,
            mode: mode?,
            filter: filter?,
        })
    }

    /// The value for a word in a list; an unknown word is an issue.
    fn one_of<T>(
        &mut self,
        key: &'a str,
        word: Option<&str>,
        meaning: impl Fn(&str) -> Option<T>,
    ) -> Option<T> {
        let word = word?;
        let value = meaning(word);
        if value.is_none() {
            self.issue("VALUE_NOT_IN_LIST", Some(key.into()), || format!("{key} {word:?} is not known"));
        }
        value
    }

    /// Whether a layout obeys the rules, and fits its view.
    fn packed_rules(&mut self, extension: &str, layout: &MeshoptLayout, view: &GltfBufferView) -> bool {
        let n_bytes = layout.n_bytes();
        let stride = view.stride.filter(|stride| extension == NAMES[0] && *stride != layout.stride);
        let length = view.length.filter(|length| *length != n_bytes);
        let broken = layout.broken_rule().or_else(|| {
            let stride = stride.map(|stride| ("byteStride", format!("the view has byteStride {stride}")));
            let length = || Some(("count", format!("the view has {} bytes and not {n_bytes}", length?)));
            stride.or_else(length)
        });
        let Some((key, what)) = broken else { return true };
        self.issue("VALUE_NOT_IN_RANGE", Some(key.into()), || what);
        false
    }

    /// Checks that streams lie inside their buffers, and that fallback buffers are used as such.
    pub(super) fn link_packed_views(&mut self, model: &GltfModel<'_>) {
        let is_fallback = |buffer| item(&model.buffers, buffer).is_some_and(|buffer| buffer.is_fallback);
        for (i, view) in model.views.iter().enumerate() {
            let Some(view) = view else { continue };
            let path = ["bufferViews".into(), i.into()];
            let Some(packed) = &view.packed else {
                if is_fallback(view.buffer) {
                    let what = "the buffer is a fallback, and the view is not compressed";
                    self.within_path(&path, |lint| lint.issue_below(FALLBACK, "buffer", what));
                }
                continue;
            };
            let Some(layout) = packed.layout else { continue };
            let path = [path[0], path[1], "extensions".into(), packed.extension.into()];
            self.within_path(&path, |lint| {
                if !lint.resolved("buffers", layout.buffer, "buffer".into()) {
                    return;
                }
                if is_fallback(Some(layout.buffer)) {
                    let what = "a compressed stream is in a buffer that is a fallback";
                    lint.issue_below(FALLBACK, "buffer", what);
                }
                let total = item(&model.buffers, Some(layout.buffer)).and_then(|buffer| buffer.byte_length);
                let end = layout.offset.saturating_add(layout.length);
                if let Some(total) = total.filter(|total| end > *total) {
                    let buffer = layout.buffer;
                    lint.issue("BUFFER_VIEW_TOO_LONG", Some("byteLength".into()), || {
                        format!("the stream ends at byte {end} of buffer {buffer}, which has {total}")
                    });
                }
            });
        }
    }
}
