//! Files that are texts, read.

use kinetarium_formats::{InMemory, Loaded, Options, Warning, parse};

pub fn read_with(body: &str, options: &Options) -> Loaded {
    let files = InMemory::default();
    parse(body, "robot.xml", &files, options).unwrap_or_else(|error| panic!("{error}"))
}

/// Why a text is refused.
pub fn refused(text: &str) -> String {
    let error = parse(text, "robot.xml", &InMemory::default(), &Options::default());
    error.expect_err("an error").to_string()
}

pub fn read(text: &str) -> Loaded {
    read_with(text, &Options::default())
}

pub fn lenient(text: &str) -> Loaded {
    read_with(
        text,
        &Options {
            lenient: true,
            ..Options::default()
        },
    )
}

pub fn lines(warnings: &[Warning]) -> Vec<String> {
    warnings.iter().map(Warning::to_string).collect()
}
