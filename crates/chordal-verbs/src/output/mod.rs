//! Results in the form of a file: its rounding, its rows, its normals, and the last check of every verb.
pub(crate) mod file_rows;
pub(crate) mod finish;
pub(crate) mod format_rounding;
pub(crate) mod normals;
pub(crate) mod notes;
pub(crate) mod output_form;
pub(crate) mod pass_through;
