//! The integration tests of chordal-io, one module a file of this folder, in one program:
//! the library is linked once and not once a file.
// `sweep.rs` counts what is allocated and is a program of its own.
mod amf;
mod bez;
mod cages;
mod collada;
mod common;
mod corpus;
mod font;
mod font_glyphs;
mod format_table;
mod gifti;
mod glb;
mod hostile_obj;
mod hostile_off;
mod hostile_ply;
mod hostile_stl;
mod json_schema;
mod materials;
mod off;
mod packed;
mod patches;
mod pictures;
mod png;
mod round_trip;
mod surfaces;
mod svg;
mod threemf;
mod tiles;
mod usd;
mod vm;
mod volumes;
mod vtk;
