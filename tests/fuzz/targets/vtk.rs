//! Fuzzing target `vtk` of `amberfield_tests::any_bytes`.
#![no_main]

use amberfield_tests::any_bytes::TARGETS;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| TARGETS[7].1(bytes));
