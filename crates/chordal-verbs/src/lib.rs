//! What every shell calls: any input, a verb, a report.
