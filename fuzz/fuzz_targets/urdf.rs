//! URDF files of any content: read or refused, fixed and floating, never a panic.
#![no_main]

use kinetarium_formats::{InMemory, Options, urdf};
use libfuzzer_sys::fuzz_target;

fuzz_target!(|text: &str| {
    for (lenient, floating_base) in [(false, false), (true, true)] {
        let options = Options {
            lenient,
            floating_base,
        };
        let _ = urdf::parse(text, "robot.urdf", &InMemory::default(), &options);
    }
});
