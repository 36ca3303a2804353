#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    sph_tests::Input::Checkpoint.read(bytes);
});
