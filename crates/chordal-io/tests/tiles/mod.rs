//! Tilesets: what is written reads back and complies, what is broken is refused.
mod bounds;
mod build;
mod data;
mod hostile;
mod implicit;
mod old_tiles;
mod write;
