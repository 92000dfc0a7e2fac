//! honesty
