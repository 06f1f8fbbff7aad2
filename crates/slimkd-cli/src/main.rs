//! The slimkd command.
fn main() {}
