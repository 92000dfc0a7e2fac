//! The integration tests of chordal-cli, one module a file of this folder, in one program:
//! the library is linked once and not once a file.
mod bake;
mod batch;
mod boolean;
mod budget;
mod cage;
mod common;
mod convert;
mod deviation;
mod drawing;
mod files;
mod hard_fields;
mod hard_inputs;
mod input;
mod inspect;
mod lod;
mod mend;
mod normals;
mod output;
mod render;
mod report;
mod script;
mod script_meshes;
mod signals;
mod studio;
mod volume;
mod volume_budget;
