//! Degrees and lists of numbers of splines, in JSON.
use super::check_rows;
use crate::grow::push;
use crate::json::JsonReader;
use crate::{Limits, ReadError};

/// A degree as an integer.
pub(super) fn whole_degree(degree: f64) -> Result<usize, String> {
    if degree.fract() != 0.0 || degree < 0.0 {
        return Err(format!("the degree {degree} is no whole number from 1 to 30"));
    }
    // A cast of a float that is too large saturates, and is refused as a degree.
    Ok(degree as usize)
}

/// A list of numbers.
pub(super) fn numbers(json: &mut JsonReader, limits: &Limits) -> Result<Vec<f64>, ReadError> {
    let mut values = Vec::new();
    json.array(|json, i| {
        check_rows(json, "numbers", i, limits)?;
        push(&mut values, json.number()?)
    })?;
    Ok(values)
}
