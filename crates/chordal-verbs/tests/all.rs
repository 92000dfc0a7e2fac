//! The integration tests of chordal-verbs, one module a file of this folder, in one program:
//! the library is linked once and not once a file.
mod assets;
mod baking;
mod cages;
mod common;
mod composed;
mod corpus;
mod deviation;
mod drawing;
mod drawing_referee;
mod lod_files;
mod looks;
mod mend;
mod mesh;
mod monotone;
mod open_scan;
mod options;
mod prescribed;
mod quantized;
mod skins;
mod solids;
mod verify_attributes;
mod verify_edits;
mod verify_formats;
