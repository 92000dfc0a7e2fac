//! 3MF: what is read of files made by hand, what is written reads back, and what is refused.
pub mod build;
mod hostile;
mod reader;
mod round_trip;
