//! A Whitted-style renderer on top of slimkd.
