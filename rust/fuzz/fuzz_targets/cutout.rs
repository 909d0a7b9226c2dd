#![no_main]

libfuzzer_sys::fuzz_target!(|data: &[u8]| gridmesh_fuzz::cutout(data));
