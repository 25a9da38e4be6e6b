//! MJCF files of any content: read or refused, strictly and leniently, never a panic.
#![no_main]

use kinetarium_formats::{InMemory, Options, mjcf};
use libfuzzer_sys::fuzz_target;

fuzz_target!(|text: &str| {
    let files = InMemory::new([("part.xml", text)]);
    for lenient in [false, true] {
        let options = Options {
            lenient,
            ..Options::default()
        };
        let _ = mjcf::parse(text, "robot.xml", &files, &options);
    }
});
