//! VTK's files of surfaces.
mod build;
mod hostile;
mod legacy;
mod round_trip;
mod xml;
