//! Pictures of shapes, ray-traced and the same on every machine.
