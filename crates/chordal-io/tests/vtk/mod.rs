//! VTK's files of surfaces, and legacy files of volumes.
mod build;
mod hostile;
mod legacy;
mod round_trip;
mod structured_points;
mod xml;
