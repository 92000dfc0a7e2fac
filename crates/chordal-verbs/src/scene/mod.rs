//! Scenes: the maps of their nodes, and their triangles moved, merged, and compared as they are shown.
pub(crate) mod drop_attributes;
pub(crate) mod flatten;
pub(crate) mod frame_nodes;
pub(crate) mod merge;
pub(crate) mod merged_parts;
pub(crate) mod placements;
pub(crate) mod shown_parts;
pub(crate) mod transform;
