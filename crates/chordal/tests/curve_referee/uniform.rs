//! uniform
