//! The `amberfield` command.

fn main() {}
