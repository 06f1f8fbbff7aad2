//! Peers and measurement.
fn main() {}
