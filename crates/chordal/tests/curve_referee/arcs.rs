//! arcs
